#include "core/estimation/difference_velocity.hpp"

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace teleop {

DifferenceVelocity::DifferenceVelocity(const Config& config) : config_{config} {
  if (!std::isfinite(config.cutoff_Hz) || config.cutoff_Hz < 0.0) {
    throw ConfigError{"velocity estimate: cutoff_Hz must be 0 (no low-pass) or more"};
  }
}

JointVector DifferenceVelocity::step(const VelocitySample& sample) noexcept {
  if (!state_.has_sample) {
    state_ = {.q = sample.q, .has_sample = true};
    return state_.qd;
  }
  const double dt = sample.dt;
  if (dt <= 0.0) return state_.qd;
  const double alpha =
      config_.cutoff_Hz > 0.0 ? -std::expm1(-2.0 * std::numbers::pi * config_.cutoff_Hz * dt) : 1.0;
  state_.qd += alpha * ((sample.q - state_.q) / dt - state_.qd);
  state_.q = sample.q;
  return state_.qd;
}

void add_settings(Settings& settings,
                  const std::string& prefix,
                  DifferenceVelocity::Config& config) {
  settings.add(prefix + "cutoff_Hz", &config.cutoff_Hz, "difference: its low-pass, 0 for none",
               {.low = 0.0, .high = 1e5});
}

}  // namespace teleop
