#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "bias", .unit = "N m", .text = "added to the delivered torque", .range = kAny},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).bias += values[0];
}

}  // namespace

const EffectKind torque_bias{
    .name = "torque_bias",
    .law = "a becomes a + bias",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
