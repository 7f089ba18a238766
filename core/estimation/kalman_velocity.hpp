#pragma once

#include <array>
#include <string>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity by a Kalman filter for angle, speed and acceleration whose jerk is white noise,
/// one a joint, with the covariance carried along, so that uneven samples are weighed as they are
/// [Belanger 1992]:
///
///     x = (q, q̇, q̈),   ẋ = (x₂, x₃, w),   E w(t) w(s) = S δ(t − s),   y = q + e,   E e² = Δ²/12.
///
/// S = jerk², Δ = 2π / counts_per_rev; rounding to counts is taken as white noise of its own
/// variance, which holds while several counts pass a sample. A steady speed and, once settled, a
/// steady acceleration are met without error: the lag is zero there. Settled at an even Δt it is a
/// Butterworth filter of order 3,
///
///     v̂/v = (2 ω s + ω²) ω / (s³ + 2 ω s² + 2 ω² s + ω³),   ω = (12 S / (Δ² Δt))^(1/6),
///
/// through which the rounding leaves with a variance of 1.5 ω³ Δt Δ²/12.
/// Thread: the loop's only. Loop: step and reset neither allocate, block nor throw.
class KalmanVelocity {
 public:
  struct Config {
    double jerk_rad_per_s3_per_rtHz = 30.0;  ///< √S, of the motion expected
  };

  /// @throws ConfigError when the jerk is not positive or a joint has no counts.
  KalmanVelocity(const Config& config, const JointVector& counts_per_rev);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }

 private:
  struct Joint {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  };
  struct State {
    std::array<Joint, kJoints> joints{};
    JointVector qd = JointVector::Zero();
    bool has_sample = false;
  };

  void start(const JointVector& q) noexcept;

  double density_;        // S
  JointVector rounding_;  // Δ²/12, rad²
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, KalmanVelocity::Config& config);

}  // namespace teleop
