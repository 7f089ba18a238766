#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "bias",
                    .unit = "N m",
                    .text = "added to the delivered torque",
                    .range = kAny,
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).bias += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  return {{{0.02 * use.at(axis).torque}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} is always pushed by {} in {} direction: a constant torque.", of.axis(),
                     of.magnitude("bias"), of.value("bias") < 0.0 ? "negative" : "positive");
}

}  // namespace

const EffectKind torque_bias{
    .name = "torque_bias",
    .law = "a becomes a + bias",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
