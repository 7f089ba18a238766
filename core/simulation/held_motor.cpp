#include "core/simulation/held_motor.hpp"

#include <algorithm>
#include <cmath>

namespace teleop {
namespace {

MotorTerms terms_of(const HeldMotor::Config& c) noexcept {
  return {
      .drive = c.pwm ? MotorTerms::Drive::pwm : MotorTerms::Drive::ideal,
      .resistance_ohm = c.resistance_ohm,
      .inductance_H = c.inductance_H,
      .supply_V = c.full_torque_Nm / c.torque_per_ampere * c.resistance_ohm,
      .carrier_Hz = c.carrier_Hz,
      .heats = true,
      .ambient_C = c.ambient_C,
      .winding_to_housing_K_per_W = c.winding_to_housing_K_per_W,
      .housing_to_ambient_K_per_W = c.housing_to_ambient_K_per_W,
      .winding_J_per_K = c.winding_J_per_K,
      .housing_J_per_K = c.housing_J_per_K,
      .copper_per_K = c.copper_per_K,
      .magnet_per_K = c.magnet_per_K,
  };
}

/// Whole carrier periods, and the command is at rest: a step holds as many as fit into 20 ms.
double step_of(const HeldMotor::Config& c) noexcept {
  constexpr double kStep_s = 0.02;
  if (!c.pwm) return kStep_s;
  const double period = 1.0 / c.carrier_Hz;
  return period * std::max(std::floor(kStep_s / period), 1.0);
}

}  // namespace

HeldMotor::HeldMotor(const Config& config) noexcept
    : config_{config},
      motor_{terms_of(config), config.torque_per_ampere},
      step_s_{step_of(config)} {}

void HeldMotor::hold(double seconds) noexcept {
  owed_s_ += seconds;
  const auto steps = std::lround(owed_s_ / step_s_);
  owed_s_ -= static_cast<double>(steps) * step_s_;
  for (long k = 0; k < steps; ++k) {
    torque_Nm_ = motor_.step(config_.torque_Nm, 0.0, 0.0, step_s_);
  }
}

}  // namespace teleop
