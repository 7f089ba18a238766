#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace teleop {

/// Time cut into buckets of equal width, the same for every series of a page, so that the page
/// needs no time of its own for any of them.
struct TimeGrid {
  double bucket_s = 1.0;  ///< bucket k covers [k, k + 1) bucket_s
  std::size_t buckets = 1;

  /// Enough buckets for [0, seconds] but no more than `most`, none narrower than `narrowest_s`.
  [[nodiscard]] static TimeGrid over(double seconds, double narrowest_s, std::size_t most);

  [[nodiscard]] std::optional<std::size_t> bucket_of(double t_s) const noexcept;
};

/// Two points a bucket, the smallest and the largest value in the order in which they occurred: no
/// peak is lost, however long the run. Buckets without a number hold NaN.
/// @pre one time a value.
[[nodiscard]] std::vector<double> decimate(const TimeGrid& grid,
                                           std::span<const double> t_s,
                                           std::span<const double> values);

}  // namespace teleop
