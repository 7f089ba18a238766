#include <array>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "depth",
                    .unit = "1",
                    .text = "share of the resistance",
                    .range = {.low = 0.0, .high = 0.9}},
    EffectParameter{
        .name = "period", .unit = "rad", .text = "of the joint angle", .range = kPositive},
    EffectParameter{
        .name = "phase", .unit = "rad", .text = "at angle zero", .range = kAny, .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.motor.at(axis).commutation = {
      .amplitude = values[0], .frequency = 2.0 * std::numbers::pi / values[1], .phase = values[2]};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} has a winding whose resistance changes by {} as its brushes pass.",
                     of.axis(), of.size("depth"));
}

}  // namespace

const EffectKind brush_commutation{
    .name = "brush_commutation",
    .law = "R becomes R (1 + depth sin(2 pi m / period + phase))",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
