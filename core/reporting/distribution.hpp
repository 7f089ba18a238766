#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace teleop {

/// Order statistics of a sample, exact: p is the smallest value of the sample that at least the
/// share p of it does not exceed (nearest rank), so every figure is one that occurred.
struct Distribution {
  std::size_t count = 0;
  double p50 = 0.0;
  double p90 = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double max = 0.0;
};

/// Values that are not finite do not count. All zero when nothing is left.
[[nodiscard]] Distribution distribution(std::vector<double> values);

/// How many values fall between neighbouring edges.
struct Histogram {
  std::vector<double> edges;  ///< one more than counts, rising
  std::vector<std::uint64_t> counts;
};

/// `bins` edges evenly spaced on a log axis from low to high, 0 < low < high. What lies outside is
/// counted in the first or last bin, so that no value is lost.
[[nodiscard]] Histogram log_histogram(std::span<const double> values,
                                      double low,
                                      double high,
                                      std::size_t bins);

}  // namespace teleop
