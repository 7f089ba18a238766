#include <array>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "bandwidth_Hz", .unit = "Hz", .text = "of the current loop", .range = kPositive},
    EffectParameter{
        .name = "current_limit_A", .unit = "A", .text = "largest current", .range = kPositive},
    EffectParameter{.name = "voltage_limit_V",
                    .unit = "V",
                    .text = "largest voltage at the motor",
                    .range = kPositive},
    EffectParameter{.name = "resistance_ohm",
                    .unit = "ohm",
                    .text = "of the winding, cold",
                    .range = kPositive,
                    .standard = 2.32},
    EffectParameter{.name = "inductance_H",
                    .unit = "H",
                    .text = "of the winding",
                    .range = kPositive,
                    .standard = 2.4e-4},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  MotorTerms& motor = terms.motor.at(axis);
  if (motor.drive != MotorTerms::Drive::ideal) {
    throw ConfigError{"linear_amplifier: the axis has a drive already"};
  }
  motor.drive = MotorTerms::Drive::linear;
  motor.bandwidth_Hz = values[0];
  motor.current_limit_A = values[1];
  motor.voltage_limit_V = values[2];
  motor.resistance_ohm = values[3];
  motor.inductance_H = values[4];
}

std::string words(const EffectValues& of) {
  return fmt::format("{} is driven by a current amplifier of {} that gives {} at most.", of.axis(),
                     of.size("bandwidth_Hz"), of.size("current_limit_A"));
}

}  // namespace

const EffectKind linear_amplifier{
    .name = "linear_amplifier",
    .law =
        "i' = 2 pi bandwidth (u / (K_t N) - i) within |i| <= current_limit and |L i' + R i + K_e N "
        "m'| <= voltage_limit",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
