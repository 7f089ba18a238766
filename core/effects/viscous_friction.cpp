#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "coefficient",
                    .unit = "N m s/rad",
                    .text = "torque per joint speed",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "asymmetry",
                    .unit = "1",
                    .text = "share by which positive motion is braked more",
                    .range = {.low = -1.0, .high = 1.0},
                    .standard = 0.0,
                    .role = EffectParameter::Role::on_evidence},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const double coefficient = values[0];
  const double asymmetry = values[1];
  terms.friction.at(axis).viscous_forward += coefficient * (1.0 + asymmetry);
  terms.friction.at(axis).viscous_backward += coefficient * (1.0 - asymmetry);
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const AxisUse& own = use.at(axis);
  return {{{0.02 * own.torque / std::max(own.speed, 1e-6), 0.0}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} loses {} times its speed: viscous friction{}.", of.axis(),
                     of.size("coefficient"), of.asymmetry());
}

}  // namespace

const EffectKind viscous_friction{
    .name = "viscous_friction",
    .law = "f = -coefficient (1 + asymmetry sgn(m')) m'",
    .repeatable = true,
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
