#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "gain", .unit = "1", .text = "delivered over commanded torque", .range = kAny},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).gain *= values[0];
}

}  // namespace

const EffectKind torque_gain{
    .name = "torque_gain",
    .law = "u becomes gain u",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
