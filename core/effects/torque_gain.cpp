#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "gain",
                    .unit = "1",
                    .text = "delivered over commanded torque",
                    .range = kAny,
                    .neutral = 1.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).gain *= values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{1.02}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} delivers {} torque than it is told: its torque constant or gain is off.",
                     of.axis(), of.departure("gain"));
}

}  // namespace

const EffectKind torque_gain{
    .name = "torque_gain",
    .law = "u becomes gain u",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
