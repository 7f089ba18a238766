#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "loss",
                    .unit = "1",
                    .text = "share lost in the long run at 0.03 N m RMS",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{
        .name = "time_constant", .unit = "s", .text = "of the warming", .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).loss = values[0];
  terms.actuation.at(axis).thermal_time_constant = values[1];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  constexpr double kWarmth = 0.03;  // N m, at which the loss is stated
  const double ratio = kWarmth / std::max(use.at(axis).torque, 1e-6);
  const double loss = std::min(0.02 * ratio * ratio, 1.0);
  return {{{loss, 1.0}}, {{loss, 4.0}}, {{loss, 15.0}}};
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} loses torque as its motor warms up, in the long run {} at 30 mNm, with a time constant "
      "of {}.",
      of.axis(), of.size("loss"), of.size("time_constant"));
}

}  // namespace

const EffectKind thermal_derating{
    .name = "thermal_derating",
    .law = "u becomes max(0.2, 1 - loss H) u; time_constant H' = (u / 0.03 N m)^2 - H",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
