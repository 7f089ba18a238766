#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/settings.hpp"
#include "core/estimation/difference_velocity.hpp"
#include "core/estimation/kalman_velocity.hpp"
#include "core/estimation/mean_velocity.hpp"
#include "core/estimation/period_velocity.hpp"
#include "core/estimation/robust_velocity.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/estimation/window_velocity.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// A joint velocity estimator chosen by name, so that the station, the tuner and every experiment
/// use the same ones (docs/theory.md, Velocity):
///
///     difference        first difference behind a low-pass
///     mean              first difference averaged over N samples
///     period            time between encoder edges, averaged over N updates
///     kalman            Kalman filter for a motion of white jerk
///     adaptive_window   slope of the longest line that the last samples allow
///     robust_exact      robust exact differentiator
///
/// Thread: the loop's only. Loop: step and reset neither allocate, block nor throw.
class VelocityEstimator {
 public:
  struct Config {
    std::string kind = "difference";  ///< one of velocity_kinds()
    DifferenceVelocity::Config difference{};
    MeanVelocity::Config mean{};
    PeriodVelocity::Config period{};
    KalmanVelocity::Config kalman{};
    WindowVelocity::Config window{};
    RobustVelocity::Config robust{};
  };

  /// @throws ConfigError: no such kind, or its own configuration cannot be used.
  VelocityEstimator(const Config& config, const JointVector& counts_per_rev);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept;

 private:
  using Estimator = std::variant<DifferenceVelocity,
                                 MeanVelocity,
                                 PeriodVelocity,
                                 KalmanVelocity,
                                 WindowVelocity,
                                 RobustVelocity>;
  [[nodiscard]] static Estimator make(const Config& config, const JointVector& counts_per_rev);

  Estimator estimator_;
};

/// Every name of VelocityEstimator::Config::kind, the default first.
[[nodiscard]] std::span<const std::string_view> velocity_kinds() noexcept;

void add_settings(Settings& settings, const std::string& prefix, VelocityEstimator::Config& config);

}  // namespace teleop
