#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "mass", .unit = "kg", .text = "at the tip", .range = kNotNegative},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  terms.load.payload_kg += values[0];
}

}  // namespace

const EffectKind payload{
    .name = "payload",
    .law = "M, C and N of a mass at the tip are added",
    .per_axis = false,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
