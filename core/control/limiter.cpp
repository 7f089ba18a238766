#include "core/control/limiter.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace teleop {
namespace {

bool is_limit(double value) noexcept { return std::isfinite(value) && value > 0.0; }

/// |v| without the overflow of a sum of squares.
double length(const Vector3& v) noexcept { return v.stableNorm(); }

}  // namespace

Limiter::Limiter(const Config& config) : config_{config}, max_torque_{config.max_torque_Nm.data()} {
  if (!is_limit(config.max_force_N) || !is_limit(config.max_slew_Nm_per_s) ||
      !std::ranges::all_of(config.max_torque_Nm, is_limit)) {
    throw ConfigError{"limiter: every limit must be more than 0 and finite"};
  }
}

Limiter::Force Limiter::limit_force(const Vector3& f) const noexcept {
  if (!f.allFinite()) return {.fault = Fault::state_not_finite};
  Force result{.f = f};
  const double size = length(f);
  if (size > config_.max_force_N) {
    result.f *= config_.max_force_N / size;
    result.limits.set(Limit::force);
  }
  return result;
}

Limiter::Torque Limiter::step(const JointVector& tau, double dt) noexcept {
  if (!tau.allFinite() || !(dt >= 0.0)) {
    state_ = {};
    return {.fault = Fault::state_not_finite};
  }
  Torque result{.tau = tau};
  const double excess = tau.cwiseAbs().cwiseQuotient(max_torque_).maxCoeff();
  if (excess > 1.0) {
    result.tau /= excess;
    result.limits.set(Limit::torque);
  }
  // Both ends lie inside the torque limits, which are convex: so does what the slew limit leaves.
  const JointVector change = result.tau - state_.tau;
  const double allowed = config_.max_slew_Nm_per_s * dt;
  const double size = length(change);
  if (size > allowed) {
    result.tau = state_.tau + change * (allowed / size);
    result.limits.set(Limit::slew);
  }
  state_.tau = result.tau;
  return result;
}

void add_settings(Settings& settings, const std::string& prefix, Limiter::Config& config) {
  settings.add(prefix + "max_force_N", &config.max_force_N, "largest coupling force at the tool",
               kPositive);
  settings.add(prefix + "max_torque_Nm", &config.max_torque_Nm, "largest torque of each joint",
               kPositive);
  settings.add(prefix + "max_slew_Nm_per_s", &config.max_slew_Nm_per_s,
               "fastest change of the joint torques", kPositive);
}

}  // namespace teleop
