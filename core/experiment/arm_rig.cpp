#include "core/experiment/arm_rig.hpp"

#include "core/effects/hand_motion.hpp"
#include "core/experiment/scenario.hpp"
#include "core/ports/peer.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

std::unique_ptr<Arm> simulate(const Scenario& scenario,
                              const ExperimentContext& context,
                              Clock& clock) {
  if (context.arm != nullptr) return nullptr;
  return std::make_unique<SimulatedArm>(
      SimulatedArm::Config{.plant = scenario.plant(), .seed = scenario.seed()}, clock);
}

/// The arm file of a simulated arm may have a name of its own, so the plant says which it is.
ArmModel model_of(const Scenario& scenario, const ExperimentContext& context) {
  return load_arm(context.arm == nullptr ? scenario.plant().arm : context.arm->arm.info().model);
}

}  // namespace

ArmRig::ArmRig(const Config& config, const Scenario& scenario, const ExperimentContext& context)
    : config_{config},
      context_{context},
      simulated_arm_{simulate(scenario, context, simulated_clock_)},
      clock_{context.arm != nullptr ? context.arm->clock : simulated_clock_},
      arm_{context.arm != nullptr ? context.arm->arm : *simulated_arm_},
      model_{model_of(scenario, context)},
      period_{static_cast<std::int64_t>(1e9 / config.rate_Hz)},
      velocity_{config.velocity, arm_.info().counts_per_rev},
      limiter_{config.limits},
      servo_{config.servo, model_},
      next_{clock_.now()} {}

ArmRig::~ArmRig() { go_limp(); }

void ArmRig::sense(const Tick& tick, Instant start) noexcept {
  state_ = arm_.read();
  turn_.t_s = seconds(tick.due - start);
  turn_.q = state_.q;
  turn_.qd = velocity_.step(
      {.q = state_.q, .period_ticks = state_.period_ticks, .dt = seconds(tick.elapsed)});
  if (state_.fault != Fault::none) {
    fault_ = state_.fault;
  } else if (!turn_.q.allFinite() || !turn_.qd.allFinite()) {
    fault_ = Fault::state_not_finite;
  } else if (turn_.qd.cwiseAbs().maxCoeff() > config_.max_joint_speed_rad_per_s) {
    fault_ = Fault::joint_speed_exceeded;
  }
}

void ArmRig::act(const JointVector& tau, double dt) noexcept {
  const Limiter::Torque limited = limiter_.step(tau, dt);
  if (limited.fault != Fault::none) {
    fault_ = limited.fault;
    go_limp();
    return;
  }
  if (limited.limits.bits() != 0) ++cut_turns_;
  tau_ = limited.tau;
  arm_.write(tau_);
  if (!on_) {
    arm_.amplifiers(true);
    on_ = true;
  }
}

void ArmRig::go_limp() noexcept {
  arm_.write(JointVector::Zero());
  arm_.amplifiers(false);
  limiter_.reset();
  on_ = false;
}

void ArmRig::remember(const Tick& tick) noexcept {
  if (tape_ == nullptr || tape_->size() == tape_->capacity()) return;
  tape_->push_back({.tick = tape_->size() + 1,
                    .stamp_ns = state_.stamp.time_since_epoch().count(),
                    .elapsed_ms = 1e3 * seconds(tick.elapsed),
                    .lateness_us = 1e6 * seconds(tick.now - tick.due),
                    .mode = static_cast<std::uint32_t>(Mode::engaged),
                    .fault = static_cast<std::uint32_t>(fault_),
                    .arm_flags = state_.flags,
                    .counts = state_.counts,
                    .period_ticks = state_.period_ticks,
                    .q_rad = turn_.q,
                    .qd_rad_per_s = turn_.qd,
                    .tau_Nm = tau_,
                    .motor_current_A = state_.motor_current,
                    .motor_temperature_C = state_.motor_temperature,
                    .tool_force_N = state_.tool_force,
                    .tool_acceleration_m_per_s2 = state_.tool_acceleration});
}

ArmRig::Ending ArmRig::move_to(const JointVector& q, double length_s, double settle_s) noexcept {
  std::optional<JointVector> from;
  return run(length_s + settle_s, [&](const ArmTurn& turn) noexcept -> std::optional<JointVector> {
    if (!from) from = turn.q;
    const double u = turn.t_s < length_s ? turn.t_s / length_s : 1.0;
    const JointVector way = q - *from;
    return servo_.step(
        turn.q, turn.qd,
        {.q = *from + minimum_jerk(u) * way,
         .qd = u < 1.0 ? JointVector{minimum_jerk_rate(u) / length_s * way} : JointVector::Zero()});
  });
}

void add_settings(Settings& settings, ArmRig::Config& config) {
  settings.add("rate_Hz", &config.rate_Hz, "turns of the loop a second",
               {.low = 100.0, .high = 20000.0});
  add_settings(settings, "velocity.", config.velocity);
  add_settings(settings, "limits.", config.limits);
  settings.add("limits.max_joint_speed_rad_per_s", &config.max_joint_speed_rad_per_s,
               "a joint that is faster is a fault", kPositive);
  add_settings(settings, "servo.", config.servo);
}

}  // namespace teleop
