#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "limit", .unit = "N m", .text = "largest torque", .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  ActuationTerms& actuation = terms.actuation.at(axis);
  actuation.limit = std::min(actuation.limit, values[0]);
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const double peak = use.at(axis).torque_peak;
  return {{{0.9 * peak}}, {{0.7 * peak}}, {{0.5 * peak}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} gives no more than {} whatever is commanded: its amplifier saturates.",
                     of.axis(), of.size("limit"));
}

}  // namespace

const EffectKind torque_saturation{
    .name = "torque_saturation",
    .law = "u becomes max(-limit, min(limit, u))",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
