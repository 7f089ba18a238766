#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "time_constant", .unit = "s", .text = "of the current loop", .range = kNotNegative},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).lag = values[0];
}

}  // namespace

const EffectKind amplifier_lag{
    .name = "amplifier_lag",
    .law = "time_constant a' = u - a",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
