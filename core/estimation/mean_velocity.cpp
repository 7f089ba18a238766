#include "core/estimation/mean_velocity.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace teleop {

MeanVelocity::MeanVelocity(const Config& config) {
  if (config.samples < 1 || config.samples > kMostSamples) {
    throw ConfigError{"velocity estimate: mean.samples must be between 1 and 5000"};
  }
  ring_.resize(static_cast<std::size_t>(config.samples) + 1);
}

JointVector MeanVelocity::step(const VelocitySample& sample) noexcept {
  if (state_.filled == 0) {
    ring_[0] = {.q = sample.q};
    state_.filled = 1;
    return state_.qd;
  }
  if (sample.dt <= 0.0) return state_.qd;
  state_.time_s += sample.dt;
  state_.newest = (state_.newest + 1) % ring_.size();
  ring_[state_.newest] = {.q = sample.q, .time_s = state_.time_s};
  state_.filled = std::min(state_.filled + 1, ring_.size());
  const std::size_t back = state_.filled - 1;
  const Past& oldest = ring_[(state_.newest + ring_.size() - back) % ring_.size()];
  state_.qd = (sample.q - oldest.q) / (state_.time_s - oldest.time_s);
  return state_.qd;
}

void add_settings(Settings& settings, const std::string& prefix, MeanVelocity::Config& config) {
  settings.add(prefix + "samples", &config.samples, "mean: first differences averaged",
               {.low = 1, .high = MeanVelocity::kMostSamples});
}

}  // namespace teleop
