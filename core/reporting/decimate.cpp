#include "core/reporting/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/contract.hpp"

namespace teleop {

TimeGrid TimeGrid::over(double seconds, double narrowest_s, std::size_t most) {
  expects(narrowest_s > 0.0 && most > 0, "a grid has buckets of some width");
  const double span_s = std::isfinite(seconds) ? std::max(seconds, narrowest_s) : narrowest_s;
  const double wanted = std::floor(span_s / narrowest_s) + 1.0;
  const double buckets = std::min(wanted, static_cast<double>(most));
  // A little wider than the span, so that the last turn falls into the last bucket.
  return {.bucket_s = std::max(narrowest_s, span_s * (1.0 + 1e-9) / buckets),
          .buckets = static_cast<std::size_t>(buckets)};
}

std::optional<std::size_t> TimeGrid::bucket_of(double t_s) const noexcept {
  const double place = t_s / bucket_s;
  const bool inside = place >= 0.0 && place < static_cast<double>(buckets);  // false of NaN too
  return inside ? std::optional{static_cast<std::size_t>(place)} : std::nullopt;
}

std::vector<double> decimate(const TimeGrid& grid,
                             std::span<const double> t_s,
                             std::span<const double> values) {
  expects(t_s.size() == values.size(), "one time a value");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  struct Extremes {
    double low = kNone;
    double high = kNone;
    bool rising = true;  ///< the lowest came before the highest
  };
  std::vector<Extremes> extremes(grid.buckets);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<std::size_t> bucket = grid.bucket_of(t_s[i]);
    if (!bucket || !std::isfinite(values[i])) continue;
    Extremes& e = extremes[*bucket];
    if (std::isnan(e.low)) {
      e.low = e.high = values[i];
    } else if (values[i] < e.low) {
      e.low = values[i];
      e.rising = false;
    } else if (values[i] > e.high) {
      e.high = values[i];
      e.rising = true;
    }
  }
  std::vector<double> points;
  points.reserve(2 * grid.buckets);
  for (const Extremes& e : extremes) {
    points.push_back(e.rising ? e.low : e.high);
    points.push_back(e.rising ? e.high : e.low);
  }
  return points;
}

}  // namespace teleop
