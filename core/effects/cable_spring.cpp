#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "of the cable",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "rest_angle",
                    .unit = "rad",
                    .text = "where it does not pull",
                    .range = kAny,
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.spring_stiffness.at(axis) += values[0];
  terms.spring_torque.at(axis) += values[0] * values[1];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const AxisUse& own = use.at(axis);
  const double range = std::max(own.high - own.low, 1e-6);
  const double stiffness = 0.03 * own.torque / range;
  return {{{stiffness, own.low}, {stiffness, own.high}}};
}

std::vector<double> sized_here(const EffectTrial& trial, std::span<const double> shares) {
  const double sum = shares[0] + shares[1];
  return {trial[0][0] * sum, (shares[0] * trial[0][1] + shares[1] * trial[1][1]) / sum};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} is pulled towards {} by {}: a cable or spring acts on it.", of.axis(),
                     of.size("rest_angle"), of.size("stiffness"));
}

}  // namespace

const EffectKind cable_spring{
    .name = "cable_spring",
    .law = "f = -stiffness (q - rest_angle)",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .sized = sized_here,
    .words = words,
};

}  // namespace teleop
