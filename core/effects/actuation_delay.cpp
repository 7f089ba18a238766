#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "delay",
                    .unit = "s",
                    .text = "from command to action",
                    .range = {.low = 0.0, .high = kMaxDelay_s},
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).delay += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{4e-4}}, {{3e-3}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} acts {} after each command: a delay on the way to the motor.", of.axis(),
                     of.size("delay"));
}

}  // namespace

const EffectKind actuation_delay{
    .name = "actuation_delay",
    .law = "u(t) becomes u(t - delay)",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
