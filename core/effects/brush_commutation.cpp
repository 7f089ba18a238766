#include <array>
#include <numbers>

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

}  // namespace

const EffectKind brush_commutation{
    .name = "brush_commutation",
    .law = "R becomes R (1 + depth sin(2 pi m / period + phase))",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
