#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "threshold",
                    .unit = "N m",
                    .text = "largest command that is lost",
                    .range = kPositive,
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).threshold = values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const double torque = use.at(axis).torque;
  return {{{0.03 * torque}}, {{0.15 * torque}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} loses the first {} of every command: a dead zone.", of.axis(),
                     of.size("threshold"));
}

}  // namespace

const EffectKind torque_deadzone{
    .name = "torque_deadzone",
    .law = "u becomes 0 if |u| <= threshold, else u - threshold sgn(u)",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
