#pragma once

#include "core/simulation/motor.hpp"

namespace teleop {

/// A motor that carries a constant torque at standstill and warms up: the heat experiment of
/// [Cavusoglu 2002, section 4.1]. The drive is a current source that holds the current, or the
/// stock PWM drive that holds the duty torque/full_torque of a supply V = R i_full: there the
/// current falls as the copper warms. Temperatures as in Motor.
/// Thread: one. Loop: hold() is bounded only by what it is asked for.
class HeldMotor {
 public:
  struct Config {
    bool pwm = false;
    double torque_Nm = 0.0;          ///< at the joint
    double torque_per_ampere = 1.0;  ///< K_t N, at the joint, N m/A
    double full_torque_Nm = 1.0;     ///< at the joint, of full duty with a cold winding
    double resistance_ohm = 2.32;
    double inductance_H = 2.4e-4;
    double carrier_Hz = 500.0;
    double winding_to_housing_K_per_W = 3.1;
    double housing_to_ambient_K_per_W = 2.05;
    double winding_J_per_K = 4.0;
    double housing_J_per_K = 60.0;
    double copper_per_K = 0.0039;
    double magnet_per_K = 0.0;
    double ambient_C = 25.6;
  };

  /// @pre every torque per ampere, resistance, capacity and frequency is positive.
  explicit HeldMotor(const Config& config) noexcept;

  /// Lets so much time pass, in whole steps of about 20 ms; what is left over is for the next call.
  void hold(double seconds) noexcept;

  [[nodiscard]] double torque_Nm() const noexcept { return torque_Nm_; }  ///< mean of the last step
  [[nodiscard]] double current_A() const noexcept { return motor_.current(); }
  [[nodiscard]] double winding_rise_K() const noexcept {
    return motor_.winding_temperature() - config_.ambient_C;
  }
  [[nodiscard]] double casing_rise_K() const noexcept {
    return motor_.housing_temperature() - config_.ambient_C;
  }

 private:
  Config config_;
  Motor motor_;
  double step_s_;
  double owed_s_ = 0.0;  ///< asked for and not yet passed
  double torque_Nm_ = 0.0;
};

}  // namespace teleop
