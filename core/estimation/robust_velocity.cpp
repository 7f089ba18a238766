#include "core/estimation/robust_velocity.hpp"

#include <cmath>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr double kAngleGain = 1.5;
constexpr double kSpeedGain = 1.1;

}  // namespace

RobustVelocity::RobustVelocity(const Config& config) : bound_{config.acceleration_rad_per_s2} {
  if (!std::isfinite(bound_) || bound_ <= 0.0) {
    throw ConfigError{
        "velocity estimate: robust_exact.acceleration_rad_per_s2 must be more than 0"};
  }
}

JointVector RobustVelocity::step(const VelocitySample& sample) noexcept {
  if (!state_.has_sample) {
    state_ = {.z0 = sample.q, .has_sample = true};
    return state_.z1;
  }
  const double dt = sample.dt;
  if (dt <= 0.0) return state_.z1;
  const double change = kSpeedGain * bound_ * dt;
  const double pull = kAngleGain * std::sqrt(bound_) * dt;
  for (Eigen::Index i = 0; i < state_.z1.size(); ++i) {
    const double b = state_.z0[i] + dt * state_.z1[i] - sample.q[i];
    const double rest = std::abs(b) - change * dt;
    if (rest <= 0.0) {
      state_.z0[i] = sample.q[i];
      state_.z1[i] -= b / dt;
      continue;
    }
    const double s = 2.0 * rest / (pull + std::sqrt(pull * pull + 4.0 * rest));
    state_.z0[i] = sample.q[i] + std::copysign(s * s, b);
    state_.z1[i] -= std::copysign(change, b);
  }
  return state_.z1;
}

void add_settings(Settings& settings, const std::string& prefix, RobustVelocity::Config& config) {
  settings.add(prefix + "acceleration_rad_per_s2", &config.acceleration_rad_per_s2,
               "robust_exact: largest joint acceleration followed", {.low = 1e-6, .high = 1e9});
}

}  // namespace teleop
