#pragma once

#include <string>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity by Levant's robust exact differentiator, a joint at a time [Levant 1998],
///
///     ż₀ = z₁ − 1.5 √L √|z₀ − q| sgn(z₀ − q),      ż₁ = −1.1 L sgn(z₀ − q),
///
/// which follows any motion with |q̈| ≤ L exactly after a finite time. Sampled implicitly, sgn taken
/// at the end of the step as a set-valued function [Mojallizadeh 2021]. With
/// b = z₀ + Δt z₁ − q and c = 1.1 L Δt²,
///
///     |b| > c    z₀ − q = s² sgn b,  s² + 1.5 √L Δt s = |b| − c,  z₁ falls by 1.1 L Δt sgn b
///     |b| ≤ c    z₀ = q,  z₁ falls by b/Δt
///
/// so that no chattering comes from the discretisation, at any L. The speed never changes by more
/// than 1.1 L Δt a sample: a count of noise does not pass, and an acceleration above L is not
/// followed. Noise bounded by ε leaves an error of the order of √(L ε), the least that any
/// differentiator can promise for such motions; where Δ ≤ c it is the first difference.
///
/// Thread: the loop's only. Loop: step and reset neither allocate, block nor throw.
class RobustVelocity {
 public:
  struct Config {
    double acceleration_rad_per_s2 = 20.0;  ///< L
  };

  struct State {
    JointVector z0 = JointVector::Zero();  ///< angle, rad
    JointVector z1 = JointVector::Zero();  ///< estimate, rad/s
    bool has_sample = false;
  };

  /// @throws ConfigError unless the acceleration is positive and finite.
  explicit RobustVelocity(const Config& config);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  double bound_;  // L
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, RobustVelocity::Config& config);

}  // namespace teleop
