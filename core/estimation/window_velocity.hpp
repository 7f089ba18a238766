#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity by first-order adaptive windowing [Janabi-Sharifi 2000]: the slope of a line
/// through the last n + 1 samples, a joint at a time, where n ≤ N is the largest for which, and for
/// all smaller n, every one of those samples lies within d of the line:
///
///     end fit     the line through the newest and the oldest, v = (q[k] − q[k−n]) / (t[k] −
///     t[k−n]) best fit    the line of least squares
///
/// with d = noise_counts · Δ, Δ = 2π / counts_per_rev. Two samples rounded to counts may pull the
/// line by a count against one between them, hence one count. Slow or steady motion is averaged
/// over the whole window, a change shortens it: the lag is about n Δt/2 and at most N Δt/2, the
/// error from rounding about Δ/(n Δt). At a steady acceleration a the end fit bends away by
/// a (n Δt)²/8, so n ≈ √(8 d/a)/Δt.
///
/// Thread: the loop's only. Loop: step and reset neither allocate, block nor throw; end fit takes
/// N, best fit N² operations a joint.
class WindowVelocity {
 public:
  struct Config {
    int samples = 30;           ///< N
    double noise_counts = 1.0;  ///< d/Δ
    bool best_fit = false;
  };

  static constexpr int kMostSamples = 64;

  /// @throws ConfigError when a number is not usable or a joint has no counts.
  WindowVelocity(const Config& config, const JointVector& counts_per_rev);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }

  /// n of each joint's last estimate.
  [[nodiscard]] const std::array<std::size_t, kJoints>& window() const noexcept {
    return state_.window;
  }

 private:
  struct Past {
    JointVector q = JointVector::Zero();
    double time_s = 0.0;
  };
  struct State {
    std::array<Past, kMostSamples + 1> ring{};
    std::size_t newest = 0;
    std::size_t filled = 0;
    std::array<std::size_t, kJoints> window{};
    JointVector qd = JointVector::Zero();
  };
  struct Fit {
    double slope = 0.0;
    std::size_t window = 0;
  };

  [[nodiscard]] const Past& past(std::size_t back) const noexcept;
  [[nodiscard]] Fit end_fit(Eigen::Index joint, std::size_t most) const noexcept;
  [[nodiscard]] Fit best_fit(Eigen::Index joint, std::size_t most) const noexcept;

  Config config_;
  JointVector bound_;  // d, rad
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, WindowVelocity::Config& config);

}  // namespace teleop
