#pragma once

#include <optional>
#include <span>

namespace teleop {

/// Growth rate of the dominant oscillation, measured at one gain.
struct GrowthPoint {
  double gain = 0.0;
  double growth_per_s = 0.0;
  double std_per_s = 0.0;
};

/// Where the growth rate passes zero.
struct Crossing {
  double gain = 0.0;
  double low = 0.0;  ///< 90 % interval
  double high = 0.0;
  double slope_per_s = 0.0;  ///< dσ / d ln g
  double chi2 = 0.0;         ///< a degree of freedom

  [[nodiscard]] double relative_width() const noexcept { return (high - low) / gain; }
};

/// Weighted straight line σ = β (u − u*) through the points, u = ln gain; points far from u* weigh
/// less, because growth bends with the gain by about ½ β (u − u*)². The interval of u* is that of
/// the ratio −α/β [Fieller 1954], deviations scaled up where the points scatter more than they
/// claim, quantiles of Student's t. Absent with fewer than three points, or a slope that is not
/// positive beyond its own deviation.
[[nodiscard]] std::optional<Crossing> find_crossing(std::span<const GrowthPoint> points);

}  // namespace teleop
