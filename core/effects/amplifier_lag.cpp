#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "time_constant",
                    .unit = "s",
                    .text = "of the current loop",
                    .range = kNotNegative,
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).lag = values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{4e-4}}, {{3e-3}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} follows its commands with a time constant of {}: a slow amplifier.",
                     of.axis(), of.size("time_constant"));
}

}  // namespace

const EffectKind amplifier_lag{
    .name = "amplifier_lag",
    .law = "time_constant a' = u - a",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
