#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "level",
                    .unit = "N m",
                    .text = "torque that keeps the joint at rest",
                    .range = kNotNegative},
    EffectParameter{.name = "asymmetry",
                    .unit = "1",
                    .text = "share by which positive motion is braked more",
                    .range = {.low = -1.0, .high = 1.0},
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const double level = values[0];
  const double asymmetry = values[1];
  terms.friction.at(axis).dry_forward += level * (1.0 + asymmetry);
  terms.friction.at(axis).dry_backward += level * (1.0 - asymmetry);
}

}  // namespace

const EffectKind coulomb_friction{
    .name = "coulomb_friction",
    .law = "f = -level (1 + asymmetry sgn(m')) sgn(m'), sgn(0) = [-1, 1]",
    .repeatable = true,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
