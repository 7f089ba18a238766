#include "core/estimation/kalman_velocity.hpp"

#include <cmath>

#include "core/base/error.hpp"
#include "core/estimation/quantum.hpp"

namespace teleop {
namespace {

// What an arm may do before its first sample: deviations of speed and acceleration.
constexpr double kSpeed_rad_per_s = 10.0;
constexpr double kAcceleration_rad_per_s2 = 1000.0;

}  // namespace

KalmanVelocity::KalmanVelocity(const Config& config, const JointVector& counts_per_rev)
    : density_{config.jerk_rad_per_s3_per_rtHz * config.jerk_rad_per_s3_per_rtHz},
      rounding_{encoder_quantum(counts_per_rev).cwiseAbs2() / 12.0} {
  if (!std::isfinite(density_) || config.jerk_rad_per_s3_per_rtHz <= 0.0) {
    throw ConfigError{"velocity estimate: kalman.jerk_rad_per_s3_per_rtHz must be more than 0"};
  }
}

void KalmanVelocity::start(const JointVector& q) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    state_.joints[i].x = {q[row], 0.0, 0.0};
    state_.joints[i].P = Eigen::Vector3d{rounding_[row], kSpeed_rad_per_s * kSpeed_rad_per_s,
                                         kAcceleration_rad_per_s2 * kAcceleration_rad_per_s2}
                             .asDiagonal();
  }
  state_.has_sample = true;
}

JointVector KalmanVelocity::step(const VelocitySample& sample) noexcept {
  if (!state_.has_sample) {
    start(sample.q);
    return state_.qd;
  }
  const double dt = sample.dt;
  if (dt <= 0.0) return state_.qd;
  Eigen::Matrix3d F;
  F << 1.0, dt, dt * dt / 2.0,  //
      0.0, 1.0, dt,             //
      0.0, 0.0, 1.0;
  const double dt3 = dt * dt * dt;
  Eigen::Matrix3d Q;
  Q << dt3 * dt * dt / 20.0, dt3 * dt / 8.0, dt3 / 6.0,  //
      dt3 * dt / 8.0, dt3 / 3.0, dt * dt / 2.0,          //
      dt3 / 6.0, dt * dt / 2.0, dt;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Joint& joint = state_.joints[i];
    joint.x = F * joint.x;
    joint.P = F * joint.P * F.transpose() + density_ * Q;
    const double innovation = sample.q[row] - joint.x[0];
    const double variance = joint.P(0, 0) + rounding_[row];
    const Eigen::Vector3d gain = joint.P.col(0) / variance;
    joint.x += gain * innovation;
    // Joseph's form: P stays positive when a gap made it huge against the rounding.
    Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
    left.col(0) -= gain;
    joint.P = left * joint.P * left.transpose() + rounding_[row] * gain * gain.transpose();
    state_.qd[row] = joint.x[1];
  }
  return state_.qd;
}

void add_settings(Settings& settings, const std::string& prefix, KalmanVelocity::Config& config) {
  settings.add(prefix + "jerk_rad_per_s3_per_rtHz", &config.jerk_rad_per_s3_per_rtHz,
               "kalman: density of the jerk expected", {.low = 1e-6, .high = 1e9});
}

}  // namespace teleop
