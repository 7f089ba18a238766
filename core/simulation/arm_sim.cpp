#include "core/simulation/arm_sim.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

JointVector vector_of(const std::array<double, 3>& values) {
  return {values[0], values[1], values[2]};
}

Duration from_ms(double ms) { return Duration{static_cast<std::int64_t>(std::llround(ms * 1e6))}; }

Plant make_plant(const SimulatedArm::Config& config,
                 const ArmModel& model,
                 const PlantTerms& terms) {
  const Reach reach = check_limits(model, config.q);
  if (reach != Reach::ok) {
    throw ConfigError{"simulated arm: cannot start there: " + std::string{text_of(reach)}};
  }
  return Plant{model,
               {.terms = terms,
                .hand = make_hand(config.hand, model, tool_position(model, config.q), config.seed,
                                  config.hand_impedance),
                .contact = config.contact,
                .stops = config.plant.workspace.stops,
                .max_step = from_ms(config.plant.integration.max_step_ms),
                .q = config.q}};
}

ArmInfo info_of(const SimulatedArm::Config& config, const ArmModel& model) {
  const std::string plant = config.plant.name.empty() ? "unnamed" : config.plant.name;
  return {.name = "sim",
          .model = model.parameters().name,
          .counts_per_rev = vector_of(model.parameters().encoder_counts_per_rev),
          .max_torque = vector_of(model.parameters().max_torque_Nm),
          .details = "plant: " + plant +
                     "; effects: " + std::to_string(config.plant.effects.size()) +
                     "; hand: " + config.hand + "; seed: " + std::to_string(config.seed),
          .simulated = true};
}

}  // namespace

SimulatedArm::SimulatedArm(const Config& config, Clock& clock)
    : SimulatedArm{config, clock, load_arm(config.plant.arm), terms_of(config.plant.effects)} {}

SimulatedArm::SimulatedArm(const Config& config,
                           Clock& clock,
                           const ArmModel& model,
                           const PlantTerms& terms)
    : config_{config},
      model_{model},
      plant_{make_plant(config, model_, terms)},
      sensing_{terms.sensing, vector_of(model_.parameters().encoder_counts_per_rev), config.q},
      accelerometer_{terms.accelerometer},
      time_ratio_{terms.time_ratio},
      noise_{config.seed},
      info_{info_of(config, model_)},
      current_per_torque_{vector_of(model_.parameters().transmission_ratio)
                              .cwiseProduct(vector_of(model_.parameters().torque_constant_Nm_per_A))
                              .cwiseInverse()},
      clock_{&clock},
      started_{clock.now()},
      now_{started_},
      last_write_{started_},
      watchdog_{from_ms(config.plant.watchdog.timeout_ms)} {
  written_.fill(JointVector::Zero());
  info_.counts_per_rev = sensing_.counts_per_rev();
  last_.stamp = started_;
  last_.counts = sensing_.counts();
  last_.q = sensing_.angles();
  for (const InjectedFault& fault : config.faults) {
    if (fault.axis >= kJoints) throw ConfigError{"simulated arm: a fault on an axis beyond 3"};
  }
}

bool SimulatedArm::is_due(const InjectedFault& fault) const noexcept {
  return now_ - started_ >= fault.at;
}

/// Time passes in pieces: what drops the torque does so at its own instant.
void SimulatedArm::live_until(Instant now) noexcept {
  const Instant reachable = std::min(now, now_ + kLongestGap);
  while (now_ < reachable) {
    Instant next = reachable;
    const bool may_starve = on_ && !starved_ && watchdog_ > Duration{0};
    if (may_starve) next = std::clamp(last_write_ + watchdog_, now_, next);
    for (const InjectedFault& fault : config_.faults) {
      const bool ahead = fault.kind == FaultKind::unplugged && !unplugged_;
      if (ahead) next = std::clamp(started_ + fault.at, now_, next);
    }
    const auto lived = static_cast<double>((next - started_ - skipped_).count());
    plant_.advance(Duration{std::llround(lived * time_ratio_)} - plant_.time(), &sensing_);
    now_ = next;
    for (const InjectedFault& fault : config_.faults) {
      unplugged_ = unplugged_ || (fault.kind == FaultKind::unplugged && is_due(fault));
    }
    starved_ = starved_ || (may_starve && now_ >= last_write_ + watchdog_ && now_ < now);
    drive_motors();
  }
  if (now > now_) {
    skipped_ += now - now_;
    now_ = now;
  }
}

void SimulatedArm::drive_motors() noexcept {
  const auto acting = static_cast<std::size_t>(config_.plant.drive.delay_samples);
  const bool live = on_ && !starved_ && !unplugged_;
  motor_torque_ = live ? written_[acting] : JointVector::Zero();
  plant_.set_torque(motor_torque_);
}

JointVector SimulatedArm::limited(const JointVector& tau) noexcept {
  const PlantSpec::Drive& drive = config_.plant.drive;
  cut_ = !tau.allFinite();
  JointVector result = cut_ ? JointVector::Zero() : tau;
  if (drive.max_force_N > 0.0) {
    const Vector3 force = linear_jacobian(model_, plant_.q()).transpose().inverse() * result;
    if (force.allFinite() && force.norm() > drive.max_force_N) {
      result *= drive.max_force_N / force.norm();
      cut_ = true;
    }
  }
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const double most = info_.max_torque[i];
    cut_ = cut_ || std::abs(result[i]) > most;
    result[i] = std::clamp(result[i], -most, most);
    const double step = drive.torque_command_step_Nm;
    if (step > 0.0) result[i] = step * std::round(result[i] / step);
  }
  return result;
}

ArmState SimulatedArm::read() noexcept {
  live_until(clock_->now());
  if (unplugged_) {
    last_.fault = Fault::device_unplugged;
    last_.flags = 0;
    last_.stamp = now_;
    return last_;
  }
  ArmState state;
  state.stamp = now_;
  state.counts = sensing_.counts();
  state.q = config_.plant.sensing.quantised ? sensing_.angles() : sensing_.exact_angles();
  state.period_ticks = sensing_.period_ticks(seconds(plant_.time()));
  read_motors(state);
  read_accelerometer(state);
  const Plant::ToolForces forces = plant_.tool_forces();
  state.tool_force = forces.hand + forces.contact;
  state.set(ArmFlag::has_currents);
  state.set(ArmFlag::has_tool_force);
  state.set(ArmFlag::has_period);
  if (on_) state.set(ArmFlag::amplifiers_on);
  if (cut_) state.set(ArmFlag::torque_cut);
  if (starved_) {
    state.set(ArmFlag::watchdog_tripped);
    state.fault = Fault::device_watchdog;
  }
  inject_faults(state);
  last_ = state;

  // Every torque is one reading older; the newest stays until it is overwritten.
  std::copy_backward(written_.begin(), written_.end() - 1, written_.end());
  drive_motors();
  return state;
}

/// Currents, and the temperatures of casings where motors heat.
void SimulatedArm::read_motors(ArmState& state) noexcept {
  state.motor_current = motor_torque_.cwiseProduct(current_per_torque_);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Motor& motor = plant_.motors()[i];
    if (motor.acts()) state.motor_current[axis] = motor.current();
    if (!motor.heats()) continue;
    state.motor_temperature[axis] = motor.housing_temperature();
    state.set(ArmFlag::has_temperatures);
  }
}

void SimulatedArm::read_accelerometer(ArmState& state) noexcept {
  if (!accelerometer_.fitted) return;
  const double passed = seconds(now_ - last_.stamp);
  const double share =
      1.0 - std::exp(-2.0 * std::numbers::pi * accelerometer_.bandwidth_Hz * passed);
  felt_ += share * (plant_.tool_acceleration() - felt_);
  for (Eigen::Index i = 0; i < felt_.size(); ++i) {
    const double reading = felt_[i] + accelerometer_.noise * noise_.normal();
    state.tool_acceleration[i] = std::clamp(reading, -accelerometer_.range, accelerometer_.range);
  }
  state.set(ArmFlag::has_acceleration);
}

void SimulatedArm::inject_faults(ArmState& state) noexcept {
  for (const InjectedFault& fault : config_.faults) {
    if (!is_due(fault)) continue;
    const auto joint = static_cast<Eigen::Index>(fault.axis);
    if (fault.kind == FaultKind::frozen_encoder) {
      state.counts[fault.axis] = last_.counts[fault.axis];
      state.q[joint] = last_.q[joint];
      state.period_ticks[fault.axis] = 0;
    }
    if (fault.kind == FaultKind::nan_angle) {
      state.q[joint] = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

void SimulatedArm::write(const JointVector& tau) noexcept {
  live_until(clock_->now());
  last_write_ = now_;
  written_[0] = limited(tau);
  drive_motors();
}

void SimulatedArm::amplifiers(bool on) noexcept {
  live_until(clock_->now());
  if (on && !on_) last_write_ = now_;
  if (!on) {
    starved_ = false;
    written_.fill(JointVector::Zero());
  }
  on_ = on;
  drive_motors();
}

SimulatedArm::Truth SimulatedArm::true_state() noexcept {
  const Plant::ToolForces forces = plant_.tool_forces();
  JointVector winding;
  for (std::size_t i = 0; i < kJoints; ++i) {
    winding[static_cast<Eigen::Index>(i)] = plant_.motors()[i].winding_temperature();
  }
  return {.q = plant_.q(),
          .qd = plant_.qd(),
          .torque = plant_.delivered_torque(),
          .winding_C = winding,
          .p_BT = tool_position(model_, plant_.q()),
          .v_BT = linear_jacobian(model_, plant_.q()) * plant_.qd(),
          .hand_force = forces.hand,
          .contact_force = forces.contact};
}

}  // namespace teleop
