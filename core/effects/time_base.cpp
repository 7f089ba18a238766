#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "ratio",
                    .unit = "1",
                    .text = "true over stated",
                    .range = {.low = 0.5, .high = 2.0},
                    .neutral = 1.0},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  terms.time_ratio *= values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{1.002}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("A sample lasts {} than stated: the clock is off.",
                     of.departure("ratio", "longer", "shorter"));
}

}  // namespace

const EffectKind time_base{
    .name = "time_base",
    .law = "true period = ratio times stated period",
    .per_axis = false,
    .channel = Channel::timing,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
