#include "core/station/station.hpp"

#include <iomanip>
#include <sstream>

#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr std::uint32_t kClutchSwitch = 1;

double microseconds(Duration duration) noexcept { return 1e6 * seconds(duration); }
double milliseconds(Duration duration) noexcept { return 1e3 * seconds(duration); }

}  // namespace

void add_settings(Settings& settings, const std::string& prefix, StationConfig& config) {
  add_settings(settings, prefix + "law.", config.law);
  settings.add(prefix + "law.computed_torque", &config.computed_torque,
               "the slave follows by computed torque instead of a force at its tool");
  settings.add(prefix + "law.hold_stiffness_N_per_m", &config.hold_stiffness_N_per_m,
               "holds the tool's place while the link is silent, 0 lets it float", kNotNegative);
  add_settings(settings, prefix + "damping.", config.damping);
  add_settings(settings, prefix + "gravity.", config.gravity);
  add_settings(settings, prefix + "computed_torque.", config.tracking);
  add_settings(settings, prefix + "velocity.", config.velocity);
  add_settings(settings, prefix + "supervisor.", config.supervisor);
  settings.add(prefix + "supervisor.engage_at_start", &config.engage_at_start,
               "couple as soon as the peer is there");
  add_settings(settings, prefix + "limits.", config.limits);
  settings.add(prefix + "limits.max_joint_speed_rad_per_s", &config.max_joint_speed_rad_per_s,
               "a joint that is faster is a fault", kPositive);
}

Station::Station(const StationConfig& config, Role role, const ArmModel& model, const Ports& ports)
    : config_{config},
      role_{role},
      model_{model},
      arm_{ports.arm},
      link_{ports.link},
      clock_{ports.clock},
      law_{config.law, role},
      damping_{config.damping},
      gravity_{config.gravity, model},
      tracking_{config.tracking, model},
      velocity_{config.velocity, ports.arm.info().counts_per_rev},
      supervisor_{config.supervisor, law_, ports.link.session()},
      limiter_{config.limits} {}

std::vector<std::string> Station::notices() const {
  std::vector<std::string> lines;
  if (!passive(config_.law)) lines.push_back(passivity_statement(config_.law));
  return lines;
}

Metadata Station::metadata() const {
  std::ostringstream scale;
  scale << std::setprecision(17) << config_.law.scale;
  std::ostringstream rotation;
  const Eigen::IOFormat one_line{Eigen::FullPrecision, Eigen::DontAlignCols, " ", " "};
  rotation << law_.rotation().format(one_line);
  return {{"law_scale", scale.str()},
          {"law_rotation", rotation.str()},
          {"law_passive", passivity_statement(config_.law)}};
}

const TickRecord& Station::step(const Tick& tick) noexcept {
  const Instant begin = clock_.now();
  own_.arm = arm_.read();
  const Instant read = clock_.now();
  limits_ = {};
  if (tick.overrun) limits_.set(Limit::overrun);
  sense(tick);
  hear();
  supervise(tick, check());
  const JointVector tau = think(seconds(tick.elapsed));
  const Instant thought = clock_.now();
  arm_.write(tau);
  const Instant written = clock_.now();
  tell(tick);

  // A simulated arm computes what a real one does by itself: that time is not the loop's.
  const Duration in_arm =
      arm_.info().simulated ? (read - begin) + (written - thought) : Duration{0};
  record_.compute_us = microseconds(clock_.now() - begin - in_arm);
  remember(tick, tau);
  return record_;
}

void Station::sense(const Tick& tick) noexcept {
  const ArmState& arm = own_.arm;
  own_.qd =
      velocity_.step({.q = arm.q, .period_ticks = arm.period_ticks, .dt = seconds(tick.elapsed)});
  own_.J = linear_jacobian(model_, arm.q);
  own_.p = tool_position(model_, arm.q);
  own_.v = own_.J * own_.qd;
  if (check_limits(model_, arm.q) != Reach::ok) limits_.set(Limit::joint_range);
  if (arm.has(ArmFlag::torque_cut)) limits_.set(Limit::device_torque);
}

void Station::hear() noexcept {
  const std::optional<PeerSample> sample = link_.receive();
  peer_is_new_ = sample.has_value();
  if (sample) peer_ = sample;
  statistics_ = link_.statistics();
}

bool Station::clutched() const noexcept { return (own_.arm.switches & kClutchSwitch) != 0; }

Fault Station::check() const noexcept {
  if (own_.arm.fault != Fault::none) return own_.arm.fault;
  if (limiter_fault_ != Fault::none) return limiter_fault_;
  if (!own_.arm.q.allFinite() || !own_.qd.allFinite()) return Fault::state_not_finite;
  if (own_.qd.cwiseAbs().maxCoeff() > config_.max_joint_speed_rad_per_s) {
    return Fault::joint_speed_exceeded;
  }
  return Fault::none;
}

void Station::supervise(const Tick& tick, Fault fault) noexcept {
  const Supervisor::Input input{
      .now = clock_.now(),
      .p_BT = own_.p,
      .peer = peer_,
      .clutch = clutched(),
      .fault = fault,
      .enable = config_.engage_at_start,
  };
  decided_ = supervisor_.step(input, seconds(tick.elapsed));
  limits_.merge(decided_.limits);
  if (decided_.mode == Mode::holding && last_mode_ != Mode::holding) hold_point_ = own_.p;
  last_mode_ = decided_.mode;
  if (decided_.amplifiers != amplifiers_on_) {
    arm_.amplifiers(decided_.amplifiers);
    amplifiers_on_ = decided_.amplifiers;
    limiter_.reset();
  }
}

JointVector Station::think(double dt) noexcept {
  coupling_.force = couple();
  if (!amplifiers_on_) {
    coupling_.force.setZero();
    return JointVector::Zero();
  }
  const Limiter::Force limited =
      limiter_.limit_force(coupling_.force + hold() + damping_.step(own_.v));
  const JointVector wanted = own_.J.transpose() * limited.f + gravity_.step(own_.arm.q);
  const Limiter::Torque torque = limiter_.step(wanted, dt);
  limits_.merge(limited.limits);
  limits_.merge(torque.limits);
  limiter_fault_ = limited.fault != Fault::none ? limited.fault : torque.fault;
  energy_J_ += coupling_.force.dot(own_.v) * dt;
  return torque.tau;
}

/// The law's force, as far as the supervisor lets it through; none before both sides have
/// references of one epoch.
Vector3 Station::couple() noexcept {
  if (!decided_.epoch_agreed && decided_.ramp == 0.0) {
    coupling_ = {};
    return Vector3::Zero();
  }
  const PositionError::Motion own{.displacement = own_.p - decided_.reference, .velocity = own_.v};
  const PositionError::Motion peer{.displacement = decided_.peer.p_BT - decided_.peer.reference,
                                   .velocity = decided_.peer.v_BT};
  coupling_ = law_.step(own, peer);
  const bool follows = config_.computed_torque && role_ == Role::slave;
  return decided_.ramp * (follows ? follow(peer) : coupling_.force);
}

/// The tool force of computed torque: f = J_v⁻ᵀ (τ − N), so that ramp and limits act on it as on
/// any other. Where the wanted place is out of reach or the arm singular, there is none.
Vector3 Station::follow(const PositionError::Motion& peer) const noexcept {
  const PositionError::Motion wanted = law_.wanted_slave(peer);
  const IkResult ik = inverse_kinematics(model_, decided_.reference + wanted.displacement,
                                         IkBranch::up, own_.arm.q[0]);
  Matrix3 J_inverse;
  bool regular = false;
  own_.J.computeInverseWithCheck(J_inverse, regular, 1e-6);
  if (ik.reach != Reach::ok || !regular) return Vector3::Zero();
  const ComputedTorque::JointMotion desired{.q = ik.q, .qd = J_inverse * wanted.velocity};
  const JointVector tau = tracking_.step(own_.arm.q, own_.qd, desired);
  return J_inverse.transpose() * (tau - gravity_torque(model_, own_.arm.q));
}

/// Ties the tool to where it was when holding began, as the coupling lets go of it.
Vector3 Station::hold() const noexcept {
  if (decided_.mode != Mode::holding) return Vector3::Zero();
  return (1.0 - decided_.ramp) * config_.hold_stiffness_N_per_m * (hold_point_ - own_.p);
}

void Station::tell(const Tick& tick) noexcept {
  link_.send({.tick = tick.index,
              .p_BT = own_.p,
              .v_BT = own_.v,
              .f_T = coupling_.force,
              .reference = decided_.reference,
              .epoch = decided_.epoch,
              .mode = decided_.mode,
              .fault = decided_.fault,
              .clutch = clutched()});
}

const TickRecord& Station::stop() noexcept {
  arm_.write(JointVector::Zero());
  arm_.amplifiers(false);
  amplifiers_on_ = false;
  link_.send({.tick = record_.tick + 1, .p_BT = own_.p});
  ++record_.tick;
  record_.stamp_ns = clock_.now().time_since_epoch().count();
  record_.mode = static_cast<std::uint32_t>(Mode::idle);
  record_.tau_Nm.setZero();
  record_.coupling_N.setZero();
  record_.ramp = 0.0;
  return record_;
}

void Station::remember(const Tick& tick, const JointVector& tau) noexcept {
  TickRecord& r = record_;
  const ArmState& arm = own_.arm;
  r.tick = tick.index;
  r.stamp_ns = arm.stamp.time_since_epoch().count();
  r.elapsed_ms = milliseconds(tick.elapsed);
  r.lateness_us = microseconds(tick.lateness());
  r.mode = static_cast<std::uint32_t>(decided_.mode);
  const Fault fault = decided_.fault != Fault::none ? decided_.fault
                      : recording_failed_           ? Fault::recording_failed
                                                    : Fault::none;
  r.fault = static_cast<std::uint32_t>(fault);
  r.limits = limits_.bits();
  r.arm_flags = arm.flags;
  r.switches = arm.switches;
  r.counts = arm.counts;
  r.period_ticks = arm.period_ticks;
  r.q_rad = arm.q;
  r.qd_rad_per_s = own_.qd;
  r.tau_Nm = tau;
  r.motor_current_A = arm.motor_current;
  r.motor_temperature_C = arm.motor_temperature;
  r.p_m = own_.p;
  r.v_m_per_s = own_.v;
  r.reference_m = decided_.reference;
  r.error_m = coupling_.error;
  r.coupling_N = coupling_.force;
  r.tool_force_N = arm.tool_force;
  r.tool_acceleration_m_per_s2 = arm.tool_acceleration;
  r.epoch = decided_.epoch;
  r.ramp = decided_.ramp;
  r.energy_J = energy_J_;
  r.packets_sent = statistics_.sent;
  r.packets_received = statistics_.received;
  r.packets_lost = statistics_.lost;
  r.packets_duplicated = statistics_.duplicated;
  r.packets_reordered = statistics_.reordered;
  if (peer_) remember_peer(*peer_, tick);
}

void Station::remember_peer(const PeerSample& sample, const Tick& tick) noexcept {
  TickRecord& r = record_;
  const PeerState& peer = sample.state;
  r.peer_session = sample.session;
  r.peer_sequence = sample.sequence;
  r.peer_tick = peer.tick;
  r.peer_sent_ns = sample.sent.time_since_epoch().count();
  r.peer_received_ns = sample.received.time_since_epoch().count();
  r.peer_mode = static_cast<std::uint32_t>(peer.mode);
  r.peer_epoch = peer.epoch;
  r.peer_p_m = peer.p_BT;
  r.peer_v_m_per_s = peer.v_BT;
  r.peer_coupling_N = peer.f_T;
  r.peer_age_ms = milliseconds(sample.age(tick.now));
  r.peer_age_bound_ms = milliseconds(sample.age_bound(tick.now));
  r.round_trip_us = peer_is_new_ && sample.has_round_trip ? microseconds(sample.round_trip) : 0.0;
}

}  // namespace teleop
