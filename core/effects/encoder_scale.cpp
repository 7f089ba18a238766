#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "scale", .unit = "1", .text = "read over true angle", .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).scale *= values[0];
}

}  // namespace

const EffectKind encoder_scale{
    .name = "encoder_scale",
    .law = "y = scale m",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
