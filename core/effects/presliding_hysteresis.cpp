#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "level", .unit = "N m", .text = "in steady sliding", .range = kPositive},
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "at the turning points",
                    .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.friction.at(axis).bristle = {
      .level = values[0], .static_level = values[0], .stiffness = values[1]};
}

}  // namespace

const EffectKind presliding_hysteresis{
    .name = "presliding_hysteresis",
    .law = "f = -z, dz/dm = stiffness (1 - (z / level) sgn(m'))",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
