#include "core/reporting/distribution.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"

namespace teleop {

Distribution distribution(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  // Shares in thousandths keep the rank exact: 0.999 n in floating point may round up a rank.
  const auto at = [&](std::size_t thousandths) {
    return values[(values.size() * thousandths + 999) / 1000 - 1];
  };
  return {.count = values.size(),
          .p50 = at(500),
          .p90 = at(900),
          .p99 = at(990),
          .p999 = at(999),
          .max = values.back()};
}

Histogram log_histogram(std::span<const double> values, double low, double high, std::size_t bins) {
  expects(low > 0.0 && high > low && bins > 0, "a log axis rises from a positive number");
  Histogram histogram{.edges = std::vector<double>(bins + 1),
                      .counts = std::vector<std::uint64_t>(bins)};
  const double ratio = std::log(high / low);
  const auto count = static_cast<double>(bins);
  for (std::size_t i = 0; i <= bins; ++i) {
    histogram.edges[i] = low * std::exp(ratio * static_cast<double>(i) / count);
  }
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    const double place = value <= low ? 0.0 : count * std::log(value / low) / ratio;
    ++histogram.counts[static_cast<std::size_t>(std::min(place, count - 1.0))];
  }
  return histogram;
}

}  // namespace teleop
