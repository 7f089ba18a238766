#pragma once

#include <array>
#include <string>

#include "core/base/fault.hpp"
#include "core/base/settings.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// Last stage before the motors. What is too large is shortened, never bent:
///
///     tool force     f ← f min(1, f_max/|f|)
///     joint torques  τ ← τ min(1, min_i τ_max,i/|τ_i|)
///     slew           τ ← τ' + (τ − τ') min(1, r Δt/|τ − τ'|),  τ' the torque of the last step
///
/// A force or torque that is not finite becomes zero at once and is reported as a fault.
/// Thread: the loop's only. Loop: no call allocates, blocks or throws.
class Limiter {
 public:
  struct Config {
    double max_force_N = 8.5;                              ///< phantom-1.5, peak
    std::array<double, 3> max_torque_Nm{1.7, 1.44, 1.44};  ///< what its motors can give
    double max_slew_Nm_per_s = 500.0;                      ///< from nothing to the peak in 4 ms
  };

  struct State {
    JointVector tau = JointVector::Zero();  ///< torque of the last step, N m
  };

  /// @throws ConfigError unless every limit is positive and finite.
  explicit Limiter(const Config& config);

  struct Force {
    Vector3 f = Vector3::Zero();  ///< N
    Limits limits{};              ///< force
    Fault fault = Fault::none;    ///< state_not_finite
  };
  [[nodiscard]] Force limit_force(const Vector3& f) const noexcept;

  struct Torque {
    JointVector tau = JointVector::Zero();  ///< N m
    Limits limits{};                        ///< torque, slew
    Fault fault = Fault::none;              ///< state_not_finite
  };
  /// Torques to be written now, `dt` seconds after the last ones.
  Torque step(const JointVector& tau, double dt) noexcept;

  /// The motors stand at zero torque: amplifiers are off.
  void reset() noexcept { state_ = {}; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  Config config_;
  JointVector max_torque_;
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, Limiter::Config& config);

}  // namespace teleop
