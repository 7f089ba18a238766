#include "core/simulation/motor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace teleop {

Motor::Motor(const MotorTerms& terms, double torque_per_ampere) noexcept
    : terms_{terms},
      torque_per_ampere_{torque_per_ampere},
      winding_{terms.ambient_C},
      housing_{terms.ambient_C},
      into_period_{terms.carrier_Hz > 0.0 ? 1.0 / terms.carrier_Hz : 0.0} {}

double Motor::longest_step() const noexcept {
  constexpr double kHeatStep = 1e-2;  // s, far below any thermal time constant
  const double electric = terms_.inductance_H / terms_.resistance_ohm;
  switch (terms_.drive) {
    case MotorTerms::Drive::linear:
      return std::min(electric, 1.0 / (2.0 * std::numbers::pi * terms_.bandwidth_Hz)) / 4.0;
    case MotorTerms::Drive::pwm:
      return std::min(1.0 / terms_.carrier_Hz, electric);
    case MotorTerms::Drive::ideal:
      break;
  }
  return kHeatStep;
}

/// The current goes to `target` at `rate` for `dt`.
void Motor::relax(double target, double rate, double dt, Sums& sums) noexcept {
  const double off = current_ - target;
  const double left = std::exp(-rate * dt);
  sums.i += target * dt + off * (1.0 - left) / rate;
  sums.ii += target * target * dt + 2.0 * target * off * (1.0 - left) / rate +
             off * off * (1.0 - left * left) / (2.0 * rate);
  current_ = target + off * left;
}

void Motor::switch_voltage(double command, double emf, double R, double dt, Sums& sums) noexcept {
  const double period = 1.0 / terms_.carrier_Hz;
  const double stall = torque_per_ampere_ * terms_.supply_V / terms_.resistance_ohm;
  const double rate = R / terms_.inductance_H;
  constexpr double kNone = 1e-12;  // s
  double left = dt;
  while (left > kNone) {
    if (into_period_ >= period - kNone) {
      into_period_ = 0.0;
      on_for_ = period * std::min(std::abs(command) / stall, 1.0);
      supply_ = std::copysign(terms_.supply_V, command);
    }
    const bool on = into_period_ < on_for_ - kNone;
    const double part = std::min(left, (on ? on_for_ : period) - into_period_);
    relax(((on ? supply_ : 0.0) - emf) / R, rate, part, sums);
    into_period_ += part;
    left -= part;
  }
}

void Motor::hold_current(double command, double emf, double R, double dt, Sums& sums) noexcept {
  const double wanted =
      std::clamp(command / torque_per_ampere_, -terms_.current_limit_A, terms_.current_limit_A);
  const double bandwidth = 2.0 * std::numbers::pi * terms_.bandwidth_Hz;
  const double voltage = terms_.inductance_H * bandwidth * (wanted - current_) + R * current_ + emf;
  if (std::abs(voltage) <= terms_.voltage_limit_V) {
    relax(wanted, bandwidth, dt, sums);
  } else {
    relax((std::copysign(terms_.voltage_limit_V, voltage) - emf) / R, R / terms_.inductance_H, dt,
          sums);
  }
}

void Motor::warm(double power, double dt) noexcept {
  // Implicit midpoint of C_w ẇ = P − (w − h)/R_wh, C_h ḣ = (w − h)/R_wh − (h − ambient)/R_ha.
  const double a = dt / (2.0 * terms_.winding_J_per_K * terms_.winding_to_housing_K_per_W);
  const double b = dt / (2.0 * terms_.housing_J_per_K * terms_.winding_to_housing_K_per_W);
  const double c = dt / (2.0 * terms_.housing_J_per_K * terms_.housing_to_ambient_K_per_W);
  const double p = dt * power / terms_.winding_J_per_K;
  const double w = winding_ - terms_.ambient_C;
  const double h = housing_ - terms_.ambient_C;
  const double right_w = w * (1.0 - a) + a * h + p;
  const double right_h = h * (1.0 - b - c) + b * w;
  const double determinant = (1.0 + a) * (1.0 + b + c) - a * b;
  winding_ = terms_.ambient_C + (right_w * (1.0 + b + c) + a * right_h) / determinant;
  housing_ = terms_.ambient_C + ((1.0 + a) * right_h + b * right_w) / determinant;
}

double Motor::step(double command, double speed, double angle, double dt) noexcept {
  const AngleWave& brush = terms_.commutation;
  double R = terms_.resistance_ohm;
  if (terms_.heats) R *= 1.0 + terms_.copper_per_K * (winding_ - terms_.ambient_C);
  if (brush.amplitude > 0.0) {
    R *= 1.0 + brush.amplitude * std::sin(brush.frequency * angle + brush.phase);
  }
  Sums sums;
  const double emf = torque_per_ampere_ * speed;
  switch (terms_.drive) {
    case MotorTerms::Drive::ideal:
      current_ = command / torque_per_ampere_;
      sums = {.i = current_ * dt, .ii = current_ * current_ * dt};
      break;
    case MotorTerms::Drive::linear:
      hold_current(command, emf, R, dt, sums);
      break;
    case MotorTerms::Drive::pwm:
      switch_voltage(command, emf, R, dt, sums);
      break;
  }
  mean_current_ = sums.i / dt;
  mean_square_ = sums.ii / dt;
  double torque_per_ampere = torque_per_ampere_;
  if (terms_.heats) {
    torque_per_ampere *= std::max(1.0 - terms_.magnet_per_K * (housing_ - terms_.ambient_C), 0.0);
    warm(R * mean_square_, dt);
  }
  return torque_per_ampere * mean_current_;
}

}  // namespace teleop
