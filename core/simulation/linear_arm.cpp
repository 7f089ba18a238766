#include "core/simulation/linear_arm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace teleop {
namespace {

ArmInfo info_of(const LinearArm::Config& config) {
  const bool sensible = config.quantum_m > 0.0 && std::isfinite(config.quantum_m) &&
                        config.noise_std_m >= 0.0 && config.max_force_N > 0.0;
  if (!sensible) throw ConfigError{"linear arm: quantum and force must be positive"};
  const JointVector r = LinearArm::lever_m();
  return {.name = config.name,
          .model = "phantom-1.5",
          .counts_per_rev = 2.0 * std::numbers::pi / config.quantum_m * r,
          .max_torque = config.max_force_N * r,
          .details = "three linear axes; seed: " + std::to_string(config.seed),
          .simulated = true};
}

}  // namespace

LinearArm::LinearArm(const Config& config, Clock& clock)
    : config_{config},
      axes_{LinearAxis{config.axes[0]}, LinearAxis{config.axes[1]}, LinearAxis{config.axes[2]}},
      info_{info_of(config)},
      encoder_{info_.counts_per_rev, JointVector::Zero()},
      random_{config.seed},
      clock_{&clock},
      started_{clock.now()},
      now_{started_} {}

void LinearArm::advance(Duration span) noexcept {
  const JointVector r = lever_m();
  MotionPiece piece{.start_s = seconds(now_ - started_), .duration_s = seconds(span)};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    piece.q0[joint] = axes_[i].reading() / r[joint];
    piece.qd0[joint] = axes_[i].reading_rate() / r[joint];
    axes_[i].advance(span);
    piece.q1[joint] = axes_[i].reading() / r[joint];
    piece.qd1[joint] = axes_[i].reading_rate() / r[joint];
  }
  if (span > Duration{0}) encoder_.observe(piece);
  now_ += span;
}

void LinearArm::live_until(Instant now) noexcept {
  const Instant reachable = std::min(now, now_ + kLongestGap);
  while (now_ < reachable) {
    Duration span = reachable - now_;
    for (const LinearAxis& axis : axes_) {
      span = std::min(span, axis.until_switch());
    }
    advance(span);
  }
  now_ = std::max(now_, now);
}

ArmState LinearArm::read() noexcept {
  live_until(clock_->now());
  ArmState state;
  state.stamp = now_;
  const JointVector r = lever_m();
  const bool noisy = config_.noise_std_m > 0.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const double noise = noisy ? config_.noise_std_m * random_.normal() : 0.0;
    const double steps = std::round((axes_[i].reading() + noise) / config_.quantum_m);
    state.counts[i] = static_cast<std::int32_t>(steps);
    state.q[joint] = steps * config_.quantum_m / r[joint];
  }
  if (!noisy) {
    state.period_ticks = encoder_.period_ticks(seconds(now_ - started_));
    state.set(ArmFlag::has_period);
  }
  if (on_) state.set(ArmFlag::amplifiers_on);
  if (cut_) state.set(ArmFlag::torque_cut);
  return state;
}

void LinearArm::write(const JointVector& tau) noexcept {
  live_until(clock_->now());
  cut_ = !tau.allFinite();
  const JointVector r = lever_m();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const double wanted = tau.allFinite() ? tau[joint] / r[joint] : 0.0;
    const double force = std::clamp(wanted, -config_.max_force_N, config_.max_force_N);
    cut_ = cut_ || force != wanted;
    if (on_) axes_[i].command(force);
  }
}

void LinearArm::amplifiers(bool on) noexcept {
  live_until(clock_->now());
  if (!on) {
    for (LinearAxis& axis : axes_) {
      axis.release();
    }
  }
  on_ = on;
}

LinearArm::Truth LinearArm::true_state() const noexcept {
  Truth truth;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    truth.position[axis] = axes_[i].position();
    truth.velocity[axis] = axes_[i].velocity();
    truth.force[axis] = axes_[i].force();
    truth.kinetic_energy_J += axes_[i].kinetic_energy();
  }
  return truth;
}

}  // namespace teleop
