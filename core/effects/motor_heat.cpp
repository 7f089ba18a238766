#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "winding_to_housing_K_per_W", .unit = "K/W", .text = "R_wh", .range = kPositive},
    EffectParameter{
        .name = "housing_to_ambient_K_per_W", .unit = "K/W", .text = "R_ha", .range = kPositive},
    EffectParameter{.name = "winding_J_per_K", .unit = "J/K", .text = "C_w", .range = kPositive},
    EffectParameter{.name = "housing_J_per_K", .unit = "J/K", .text = "C_h", .range = kPositive},
    EffectParameter{.name = "copper_per_K",
                    .unit = "1/K",
                    .text = "rise of the resistance",
                    .range = kNotNegative,
                    .standard = 0.0039},
    EffectParameter{.name = "magnet_per_K",
                    .unit = "1/K",
                    .text = "fall of the torque constant with the housing",
                    .range = kNotNegative,
                    .standard = 0.0},
    EffectParameter{.name = "ambient_C",
                    .unit = "degC",
                    .text = "of the room, where it starts",
                    .range = kAny,
                    .standard = 25.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  MotorTerms& motor = terms.motor.at(axis);
  motor.heats = true;
  motor.winding_to_housing_K_per_W = values[0];
  motor.housing_to_ambient_K_per_W = values[1];
  motor.winding_J_per_K = values[2];
  motor.housing_J_per_K = values[3];
  motor.copper_per_K = values[4];
  motor.magnet_per_K = values[5];
  motor.ambient_C = values[6];
}

std::string words(const EffectValues& of) {
  return fmt::format("{} has a motor that warms up by {} of its losses.", of.axis(),
                     of.size("housing_to_ambient_K_per_W"));
}

}  // namespace

const EffectKind motor_heat{
    .name = "motor_heat",
    .law =
        "C_w T_w' = R i^2 - (T_w - T_h) / R_wh; C_h T_h' = (T_w - T_h) / R_wh - (T_h - ambient) / "
        "R_ha",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
