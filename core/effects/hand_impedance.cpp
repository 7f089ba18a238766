#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "stiffness", .unit = "N/m", .text = "of the grip", .range = kNotNegative},
    EffectParameter{
        .name = "damping", .unit = "N s/m", .text = "of the grip", .range = kNotNegative},
    EffectParameter{
        .name = "mass", .unit = "kg", .text = "that moves with the tool", .range = kNotNegative},
    EffectParameter{.name = "posture_1",
                    .unit = "rad",
                    .text = "q1 of the posture whose tool position is p_0",
                    .range = kAny,
                    .standard = 0.0},
    EffectParameter{
        .name = "posture_2", .unit = "rad", .text = "q2 of it", .range = kAny, .standard = 0.40},
    EffectParameter{
        .name = "posture_3", .unit = "rad", .text = "q3 of it", .range = kAny, .standard = 0.25},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  LoadTerms& load = terms.load;
  load.grip_stiffness = values[0];
  load.grip_damping = values[1];
  load.grip_mass = values[2];
  load.grip_posture = {values[3], values[4], values[5]};
}

}  // namespace

const EffectKind hand_impedance{
    .name = "hand_impedance",
    .law = "F = -stiffness (p - p_0) - damping p'; mass moves with the tool and has no weight here",
    .per_axis = false,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
