#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "level",
                    .unit = "N m",
                    .text = "torque that keeps the joint at rest",
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
  const double level = values[0];
  const double asymmetry = values[1];
  terms.friction.at(axis).dry_forward += level * (1.0 + asymmetry);
  terms.friction.at(axis).dry_backward += level * (1.0 - asymmetry);
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  return {{{0.03 * use.at(axis).torque, 0.0}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} loses {} against every motion: dry friction{}.", of.axis(),
                     of.size("level"), of.asymmetry());
}

}  // namespace

const EffectKind coulomb_friction{
    .name = "coulomb_friction",
    .law = "f = -level (1 + asymmetry sgn(m')) sgn(m'), sgn(0) = [-1, 1]",
    .repeatable = true,
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
