#include <algorithm>
#include <array>

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

}  // namespace

const EffectKind torque_saturation{
    .name = "torque_saturation",
    .law = "u becomes max(-limit, min(limit, u))",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
