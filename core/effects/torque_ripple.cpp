#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "amplitude",
                    .unit = "N m",
                    .text = "of the torque",
                    .range = kPositive,
                    .neutral = 0.0},
    EffectParameter{.name = "period",
                    .unit = "rad",
                    .text = "of the joint angle",
                    .range = kPositive,
                    .role = EffectParameter::Role::given},
    EffectParameter{
        .name = "phase", .unit = "rad", .text = "at angle zero", .range = kAny, .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const AngleWave wave{
      .amplitude = values[0], .frequency = 2.0 * std::numbers::pi / values[1], .phase = values[2]};
  if (!terms.actuation.at(axis).ripple.push(wave)) {
    throw ConfigError{"torque_ripple: at most four on one axis"};
  }
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  constexpr int kMostCycles = 6;  // a motor turn
  const AxisUse& own = use.at(axis);
  std::vector<EffectTrial> all;
  for (int n = 1; n <= kMostCycles; ++n) {
    const double period = 2.0 * std::numbers::pi / (own.ratio * static_cast<double>(n));
    const double amplitude = 0.02 * own.torque;
    all.push_back({{amplitude, period, 0.0}, {amplitude, period, std::numbers::pi / 2.0}});
  }
  return all;
}

std::vector<double> sized_here(const EffectTrial& trial, std::span<const double> shares) {
  const double amplitude = trial[0][0] * std::hypot(shares[0], shares[1]);
  return {amplitude, trial[0][1], std::atan2(shares[1], shares[0])};
}

std::string words(const EffectValues& of) {
  const double times = 2.0 * std::numbers::pi / of.value("period");
  return fmt::format("{} is pushed to and fro by {}, {:.3g} times a turn of the joint: cogging.",
                     of.axis(), of.size("amplitude"), times);
}

}  // namespace

const EffectKind torque_ripple{
    .name = "torque_ripple",
    .law = "a becomes a + amplitude sin(2 pi m / period + phase)",
    .repeatable = true,
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .sized = sized_here,
    .words = words,
};

}  // namespace teleop
