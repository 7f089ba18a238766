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
                    .unit = "rad",
                    .text = "of the reading",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{
        .name = "phase", .unit = "rad", .text = "at angle zero", .range = kAny, .standard = 0.0},
    EffectParameter{.name = "cycles_per_joint_rev",
                    .unit = "1",
                    .text = "1: on the joint; the transmission ratio: on the motor",
                    .range = kPositive,
                    .standard = 1.0,
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const AngleWave wave{.amplitude = values[0], .frequency = values[2], .phase = values[1]};
  if (!terms.sensing.at(axis).waves.push(wave)) {
    throw ConfigError{"encoder_eccentricity: at most four on one axis"};
  }
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const AxisUse& own = use.at(axis);
  std::vector<EffectTrial> all;
  for (const double cycles : {1.0, own.ratio}) {
    const double amplitude = 2e-3 / cycles;
    all.push_back({{amplitude, 0.0, cycles}, {amplitude, std::numbers::pi / 2.0, cycles}});
  }
  return all;
}

std::vector<double> sized_here(const EffectTrial& trial, std::span<const double> shares) {
  const double amplitude = trial[0][0] * std::hypot(shares[0], shares[1]);
  return {amplitude, std::atan2(shares[1], shares[0]), trial[0][2]};
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} misreads its angle by up to {}, {:.3g} times a turn of the joint: a code wheel "
      "off centre.",
      of.axis(), of.size("amplitude"), of.value("cycles_per_joint_rev"));
}

}  // namespace

const EffectKind encoder_eccentricity{
    .name = "encoder_eccentricity",
    .law = "y = m + amplitude sin(cycles_per_joint_rev m + phase)",
    .repeatable = true,
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .sized = sized_here,
    .words = words,
};

}  // namespace teleop
