#include "core/estimation/velocity.hpp"

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace teleop {

DifferenceVelocity::DifferenceVelocity(const Config& config) : config_{config} {
  if (!std::isfinite(config.cutoff_Hz) || config.cutoff_Hz <= 0.0) {
    throw ConfigError{"velocity estimate: cutoff_Hz must be more than 0"};
  }
}

JointVector DifferenceVelocity::step(const JointVector& q, double dt) noexcept {
  if (!state_.has_sample) {
    state_ = {.q = q, .has_sample = true};
    return state_.qd;
  }
  if (dt <= 0.0) return state_.qd;
  const double alpha = -std::expm1(-2.0 * std::numbers::pi * config_.cutoff_Hz * dt);
  state_.qd += alpha * ((q - state_.q) / dt - state_.qd);
  state_.q = q;
  return state_.qd;
}

void add_settings(Settings& settings,
                  const std::string& prefix,
                  DifferenceVelocity::Config& config) {
  settings.add(prefix + "cutoff_Hz", &config.cutoff_Hz, "low-pass of the velocity estimate",
               {.low = 1.0, .high = 1e5});
}

}  // namespace teleop
