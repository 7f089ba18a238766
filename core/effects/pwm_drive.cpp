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
        .name = "supply_V", .unit = "V", .text = "that is switched", .range = kPositive},
    EffectParameter{.name = "carrier_Hz",
                    .unit = "Hz",
                    .text = "of the switching",
                    .range = {.low = 500.0, .high = 1e6}},
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
    throw ConfigError{"pwm_drive: the axis has a drive already"};
  }
  motor.drive = MotorTerms::Drive::pwm;
  motor.supply_V = values[0];
  motor.carrier_Hz = values[1];
  motor.resistance_ohm = values[2];
  motor.inductance_H = values[3];
}

std::string words(const EffectValues& of) {
  return fmt::format("{} is driven by a voltage of {} that is switched at {}.", of.axis(),
                     of.size("supply_V"), of.size("carrier_Hz"));
}

}  // namespace

const EffectKind pwm_drive{
    .name = "pwm_drive",
    .law =
        "V = supply for |u| / stall of a period, else 0; L i' = V - R i - K_e N m'; stall = K_t N "
        "supply / R",
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
