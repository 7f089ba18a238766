#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/estimation/velocity_sample.hpp"

namespace teleop::testing {

/// An encoder with a period counter that watches a motion q(t) of all three joints: edges are found
/// by interpolation on a grid of 2 µs. Written apart from the simulated arm's.
class WatchedEncoder {
 public:
  static constexpr double kCounts = 47513.6;  ///< a revolution
  static constexpr double kQuantum = 2.0 * std::numbers::pi / kCounts;

  /// Displacement of the line above count n, in quanta, by n mod 4: unequal quadrature.
  std::vector<double> spacing{0.0, 0.0, 0.0, 0.0};

  /// Lets t run to `until` and gives the reading there.
  template <class Motion>
  VelocitySample read(Motion&& q, double until) {
    constexpr double kGrid = 2e-6;
    const double begin = t_;
    while (t_ < until) {
      const double t0 = t_;
      const double x0 = q(t0) / kQuantum;
      t_ = std::min(t0 + kGrid, until);
      const double x1 = q(t_) / kQuantum;
      const auto crossing = [&](double line) {
        return t0 + (t_ - t0) * (line - x0) / (x1 - x0);
      };
      for (; x1 > line(count_); ++count_) {
        edge(crossing(line(count_)), 1);
      }
      for (; x1 < line(count_ - 1); --count_) {
        edge(crossing(line(count_ - 1)), -1);
      }
    }
    const double ticks = std::max(std::round(period_ * 1e7), 1.0);
    const bool overflow = period_ * 1e7 > 65535.0 || (t_ - last_) * 1e7 > 65535.0;
    const auto word = static_cast<std::int32_t>(overflow ? 0.0 : ticks * direction_);
    return {.q = JointVector::Constant(static_cast<double>(count_) * kQuantum),
            .period_ticks = {word, word, word},
            .dt = t_ - begin};
  }

 private:
  [[nodiscard]] double line(std::int64_t n) const {
    return static_cast<double>(n) + 0.5 + spacing[static_cast<std::size_t>(n & 3)];
  }
  void edge(double when, int direction) {
    period_ = when - last_;
    last_ = when;
    direction_ = direction;
  }

  double t_ = 0.0;
  std::int64_t count_ = 0;
  double last_ = -1.0;
  double period_ = 1.0;
  int direction_ = 1;
};

}  // namespace teleop::testing
