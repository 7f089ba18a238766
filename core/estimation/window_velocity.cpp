#include "core/estimation/window_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/estimation/quantum.hpp"

namespace teleop {

WindowVelocity::WindowVelocity(const Config& config, const JointVector& counts_per_rev)
    : config_{config}, bound_{config.noise_counts * encoder_quantum(counts_per_rev)} {
  if (config.samples < 1 || config.samples > kMostSamples) {
    throw ConfigError{"velocity estimate: adaptive_window.samples must be between 1 and 64"};
  }
  if (!std::isfinite(config.noise_counts) || config.noise_counts <= 0.0) {
    throw ConfigError{"velocity estimate: adaptive_window.noise_counts must be more than 0"};
  }
}

const WindowVelocity::Past& WindowVelocity::past(std::size_t back) const noexcept {
  constexpr std::size_t kSize = kMostSamples + 1;
  return state_.ring[(state_.newest + kSize - back) % kSize];
}

JointVector WindowVelocity::step(const VelocitySample& sample) noexcept {
  if (state_.filled == 0) {
    state_.ring[0] = {.q = sample.q};
    state_.filled = 1;
    return state_.qd;
  }
  if (sample.dt <= 0.0) return state_.qd;
  const double now = past(0).time_s + sample.dt;
  state_.newest = (state_.newest + 1) % state_.ring.size();
  state_.ring[state_.newest] = {.q = sample.q, .time_s = now};
  state_.filled = std::min(state_.filled + 1, state_.ring.size());
  const std::size_t most = std::min(state_.filled - 1, static_cast<std::size_t>(config_.samples));
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const Fit fit = config_.best_fit ? best_fit(joint, most) : end_fit(joint, most);
    state_.qd[joint] = fit.slope;
    state_.window[i] = fit.window;
  }
  return state_.qd;
}

/// Each sample between allows a range of slopes to the line through the newest; a window fits when
/// its own slope is in all of them.
WindowVelocity::Fit WindowVelocity::end_fit(Eigen::Index joint, std::size_t most) const noexcept {
  const double d = bound_[joint];
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  Fit fit;
  for (std::size_t n = 1; n <= most; ++n) {
    const double span = past(0).time_s - past(n).time_s;
    const double rise = past(0).q[joint] - past(n).q[joint];
    const double slope = rise / span;
    if (slope < low || slope > high) return fit;
    fit = {.slope = slope, .window = n};
    low = std::max(low, (rise - d) / span);
    high = std::min(high, (rise + d) / span);
  }
  return fit;
}

WindowVelocity::Fit WindowVelocity::best_fit(Eigen::Index joint, std::size_t most) const noexcept {
  // Seen from the newest sample, so that the sums keep their digits.
  double sum_t = 0.0;
  double sum_q = 0.0;
  double sum_tt = 0.0;
  double sum_tq = 0.0;
  Fit fit;
  for (std::size_t n = 1; n <= most; ++n) {
    const double t = past(n).time_s - past(0).time_s;
    const double q = past(n).q[joint] - past(0).q[joint];
    sum_t += t;
    sum_q += q;
    sum_tt += t * t;
    sum_tq += t * q;
    const auto count = static_cast<double>(n + 1);
    const double slope = (count * sum_tq - sum_t * sum_q) / (count * sum_tt - sum_t * sum_t);
    const double offset = (sum_q - slope * sum_t) / count;
    for (std::size_t i = 0; i <= n; ++i) {
      const double line = offset + slope * (past(i).time_s - past(0).time_s);
      const double off = past(i).q[joint] - past(0).q[joint] - line;
      if (std::abs(off) > bound_[joint]) return fit;
    }
    fit = {.slope = slope, .window = n};
  }
  return fit;
}

void add_settings(Settings& settings, const std::string& prefix, WindowVelocity::Config& config) {
  settings.add(prefix + "samples", &config.samples, "adaptive_window: longest window",
               {.low = 1, .high = WindowVelocity::kMostSamples});
  settings.add(prefix + "noise_counts", &config.noise_counts,
               "adaptive_window: a sample may be so far from the line", kPositive);
  settings.add(prefix + "best_fit", &config.best_fit,
               "adaptive_window: least squares instead of the line through the ends");
}

}  // namespace teleop
