#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity as the stock electronics of the PHANToM give it: the first difference averaged
/// over N samples,
///
///     v[k] = (q[k] − q[k−N]) / (t[k] − t[k−N]),
///
/// which for even samples is the mean of N first differences and stays exact for a steady speed
/// when they are uneven. It lags by N Δt/2: 50 ms for the stock N = 100 at 1 kHz, 49.5 ms of the
/// average and 0.5 ms of the difference. White noise of deviation σ in q leaves as √2 σ/(N Δt), a
/// step of Δ in q as Δ/(N Δt). Source: [Cavusoglu 2002, section 4.1.2].
///
/// Thread: the loop's only. Loop: step and reset neither allocate, block nor throw.
class MeanVelocity {
 public:
  struct Config {
    int samples = 100;  ///< N, 1 is the first difference
  };

  struct State {
    std::size_t newest = 0;  ///< its place in the ring
    std::size_t filled = 0;  ///< samples in the ring, at most N + 1
    double time_s = 0.0;     ///< of the newest, since the first
    JointVector qd = JointVector::Zero();
  };

  static constexpr int kMostSamples = 5000;

  /// @throws ConfigError unless samples is 1 to kMostSamples.
  explicit MeanVelocity(const Config& config);

  /// The estimate after a sample, rad/s: zero after the first; until N + 1 are there, over those
  /// that are. With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  struct Past {
    JointVector q = JointVector::Zero();
    double time_s = 0.0;
  };

  std::vector<Past> ring_;  // N + 1 samples
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, MeanVelocity::Config& config);

}  // namespace teleop
