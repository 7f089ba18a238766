#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "mass", .unit = "kg", .text = "at the tip", .range = kNotNegative, .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  terms.load.payload_kg += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{2e-3}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("The tool carries {} more than the model knows: a payload.", of.size("mass"));
}

}  // namespace

const EffectKind payload{
    .name = "payload",
    .law = "M, C and N of a mass at the tip are added",
    .per_axis = false,
    .channel = Channel::load,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
