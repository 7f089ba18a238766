#pragma once

#include <optional>
#include <span>

namespace teleop {

/// Growth rate of the dominant oscillation, measured at one gain.
struct GrowthPoint {
  double gain = 0.0;
  double growth_per_s = 0.0;
  double std_per_s = 0.0;
  double log_amplitude = 0.0;  ///< ln of the amplitude it was measured at, over A
};

/// Where the growth rate passes zero.
struct Crossing {
  double gain = 0.0;
  double low = 0.0;  ///< 90 % interval
  double high = 0.0;
  double slope_per_s = 0.0;    ///< dσ / d ln g
  double scatter_per_s = 0.0;  ///< deviation of the points beyond what they claim

  [[nodiscard]] double relative_width() const noexcept { return (high - low) / gain; }
};

/// Regression of growth rate on log gain,
///
///     σ_i = β (u_i − u*) + γ (u_i − u*)² + κ a_i + scatter + error_i,
///     u = ln gain, a = ln amplitude/A.
///
/// The bend γ is held near zero by a prior of deviation β/2 (growth that is linear in the gain has
/// γ = β/2). κ by another: friction makes growth depend on amplitude. Beyond the
/// deviations that the points claim they scatter, because rounding makes growth depend on where the
/// counts fall; the scatter is the one that makes χ² equal its degrees of freedom [Mandel 1970,
/// random effects]. The interval of u* takes Student's t and is never narrower than a deviation of
/// 5e-4 gives: rounding shifts all probes of an arm alike. Absent with fewer than three points, or
/// where the slope is not positive beyond its own deviation.
[[nodiscard]] std::optional<Crossing> find_crossing(std::span<const GrowthPoint> points);

}  // namespace teleop
