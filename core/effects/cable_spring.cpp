#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "stiffness", .unit = "N m/rad", .text = "of the cable", .range = kNotNegative},
    EffectParameter{.name = "rest_angle",
                    .unit = "rad",
                    .text = "where it does not pull",
                    .range = kAny,
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.spring_stiffness.at(axis) += values[0];
  terms.spring_torque.at(axis) += values[0] * values[1];
}

}  // namespace

const EffectKind cable_spring{
    .name = "cable_spring",
    .law = "f = -stiffness (q - rest_angle)",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
