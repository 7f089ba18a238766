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
                    .text = "of the tendon, seen from the joint",
                    .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).tendon_stiffness = values[0];
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} reads an angle that gives way under torque by a spring of {}: a soft tendon.", of.axis(),
      of.size("stiffness"));
}

}  // namespace

const EffectKind tendon_compliance{
    .name = "tendon_compliance",
    .law = "y = m + a / stiffness",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
