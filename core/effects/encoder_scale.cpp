#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "scale",
                    .unit = "1",
                    .text = "read over true angle",
                    .range = kPositive,
                    .neutral = 1.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).scale *= values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{1.01}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} reads {} than it turns: its encoder has another number of counts.",
                     of.axis(), of.departure("scale"));
}

}  // namespace

const EffectKind encoder_scale{
    .name = "encoder_scale",
    .law = "y = scale m",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
