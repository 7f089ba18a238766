#pragma once

#include "core/effects/plant_terms.hpp"

namespace teleop {

/// The motor of one axis behind its amplifier: current and temperatures. Within a step the speed is
/// taken as constant; the current then follows exactly, switching instants of the PWM included, and
/// the torque handed to the mechanics is its mean over the step. The two thermal nodes follow the
/// implicit midpoint rule.
/// Loop: allocation-free, noexcept.
class Motor {
 public:
  /// @param torque_per_ampere K_t N, N m/A at the joint.
  Motor(const MotorTerms& terms, double torque_per_ampere) noexcept;

  /// Mean torque at the joint over the next `dt` seconds, N m.
  /// @param command demanded torque; @param speed, angle of the drive in the middle of the step
  double step(double command, double speed, double angle, double dt) noexcept;

  /// It does more than pass the command on.
  [[nodiscard]] bool acts() const noexcept {
    return terms_.drive != MotorTerms::Drive::ideal || terms_.heats;
  }

  /// Longest step in which a constant speed and command are a good account, s.
  [[nodiscard]] double longest_step() const noexcept;

  [[nodiscard]] double current() const noexcept { return mean_current_; }     ///< A, of last step
  [[nodiscard]] double mean_square() const noexcept { return mean_square_; }  ///< A², of last step
  [[nodiscard]] double winding_temperature() const noexcept { return winding_; }  ///< °C
  [[nodiscard]] double housing_temperature() const noexcept { return housing_; }  ///< °C
  [[nodiscard]] bool heats() const noexcept { return terms_.heats; }

 private:
  struct Sums {
    double i = 0.0;   ///< ∫ i dt
    double ii = 0.0;  ///< ∫ i² dt
  };

  void relax(double target, double rate, double dt, Sums& sums) noexcept;
  void switch_voltage(double command, double emf, double R, double dt, Sums& sums) noexcept;
  void hold_current(double command, double emf, double R, double dt, Sums& sums) noexcept;
  void warm(double power, double dt) noexcept;

  MotorTerms terms_;
  double torque_per_ampere_;
  double current_ = 0.0;
  double mean_current_ = 0.0;
  double mean_square_ = 0.0;
  double winding_;
  double housing_;
  double into_period_ = 0.0;  ///< of the PWM, s
  double on_for_ = 0.0;       ///< of this period, s
  double supply_ = 0.0;       ///< signed, of this period
};

}  // namespace teleop
