#pragma once

#include <string>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity from sampled joint angles: first difference behind a first-order low-pass,
///
///     v[k] = v[k−1] + α ((q[k] − q[k−1]) / Δt − v[k−1]),   α = 1 − exp(−2π f_c Δt).
///
/// Δt is the measured time between the two samples, so a late sample does no harm. A steady speed
/// is met exactly. The estimate lags by Δt/2 + Δt (1 − α)/α; white noise of deviation σ in q
/// leaves as σ/Δt · √(2α²/(2 − α)). With f_c = 0 there is no low-pass: α = 1.
///
/// The default of 300 Hz lags 0.68 ms at 1 kHz. At 200 Hz the shipped law, at half its marginal
/// gain, follows a fast and stiff hand only just within 2 mm; beyond 300 Hz little is gained but
/// the noise of the encoder (docs/theory.md). Thread: the loop's only. Loop: step and reset neither
/// allocate, block nor throw.
class DifferenceVelocity {
 public:
  struct Config {
    double cutoff_Hz = 300.0;  ///< 0: the pure first difference
  };

  struct State {
    JointVector q = JointVector::Zero();   ///< last sample, rad
    JointVector qd = JointVector::Zero();  ///< estimate, rad/s
    bool has_sample = false;
  };

  /// @throws ConfigError unless the cutoff is finite and not negative.
  explicit DifferenceVelocity(const Config& config);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  Config config_;
  State state_{};
};

void add_settings(Settings& settings,
                  const std::string& prefix,
                  DifferenceVelocity::Config& config);

}  // namespace teleop
