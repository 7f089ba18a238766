#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "core/model/kinematics.hpp"
#include "core/simulation/bristle.hpp"
#include "core/simulation/plant.hpp"

// The equation of motion at one instant, and the choice of its forms.

namespace teleop {
namespace {

std::array<Motor, kJoints> make_motors(const ArmModel& arm, const PlantTerms& terms) {
  const auto each = [&](std::size_t i) {
    return Motor{terms.motor[i], arm.parameters().transmission_ratio.at(i) *
                                     arm.parameters().torque_constant_Nm_per_A.at(i)};
  };
  return {each(0), each(1), each(2)};
}

double massless_hand(const Plant::Config& config) {
  return (config.hand ? config.hand->config().mass_kg : 0.0) + config.terms.load.grip_mass;
}

double wave_sum(const ShortList<AngleWave, 4>& waves, double angle) noexcept {
  double sum = 0.0;
  for (const AngleWave& wave : waves) {
    sum += wave.amplitude * std::sin(wave.frequency * angle + wave.phase);
  }
  return sum;
}

}  // namespace

Plant::Plant(const ArmModel& arm, const Config& config)
    : body_{arm, massless_hand(config), config.terms.load},
      stops_{arm, config.stops, config.terms.walls},
      config_{config},
      chain_{config.terms.actuation},
      motors_{make_motors(arm, config.terms)},
      q_{config.q},
      qd_{config.qd},
      m_{config.q},
      md_{config.qd} {
  expects(config.max_step.count() > 0, "the longest step of a plant is positive");
  expects(q_.allFinite() && qd_.allFinite(), "a plant starts from a finite state");
  const auto& posture = config.terms.load.grip_posture;
  grip_point_ = tool_position(arm, {posture[0], posture[1], posture[2]});
  set_rates(arm);
  settle();
}

/// Flags of what acts, and the steps that it asks for.
void Plant::set_rates(const ArmModel& arm) {
  // Half of the inertia at home bounds it from below over the workspace.
  const auto& lumped = arm.lumped();
  const double l1 = arm.parameters().l1_m;
  const double l2 = arm.parameters().l2_m;
  const double mass = std::min(lumped.M22 / (l1 * l1), lumped.M33 / (l2 * l2)) / 2.0;
  inertia_ = std::min(lumped.M22, lumped.M33) / 2.0;
  const PlantTerms& terms = config_.terms;
  double rate = config_.hand ? config_.hand->rate(mass) : 0.0;
  if (terms.load.has_grip()) {
    rate = std::max(
        {rate, std::sqrt(terms.load.grip_stiffness / mass), terms.load.grip_damping / mass});
  }
  double motor_step = 1.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointFriction& friction = terms.friction[i];
    const Transmission& transmission = terms.transmission[i];
    const bool split = transmission.kind != Transmission::Kind::rigid;
    const double moved = split ? std::min(inertia_, transmission.drive_inertia) : inertia_;
    rate = std::max({rate, friction.viscous_forward / moved, friction.viscous_backward / moved,
                     friction.bristle.micro_damping / moved,
                     std::sqrt(friction.bristle.stiffness / moved),
                     std::sqrt(terms.spring_stiffness[i] / inertia_)});
    if (friction.stribeck_rise > 0.0) {
      rate = std::max(rate, friction.stribeck_rise / (friction.stribeck_velocity * moved));
    }
    for (const AngleWave& wave : terms.actuation[i].ripple) {
      rate = std::max(rate, std::sqrt(wave.amplitude * wave.frequency / moved));
    }
    if (transmission.kind == Transmission::Kind::compliant) {
      const double both = 1.0 / transmission.drive_inertia + 1.0 / inertia_;
      rate =
          std::max({rate, std::sqrt(transmission.stiffness * both), transmission.damping * both});
    }
    splits_ = splits_ || split;
    springs_ = springs_ || terms.spring_stiffness[i] > 0.0;
    bristles_ = bristles_ || friction.bristle.level > 0.0;
    peaks_ = peaks_ || friction.stribeck_rise > 0.0;
    ripples_ = ripples_ || !terms.actuation[i].ripple.empty();
    tendons_ = tendons_ || terms.sensing[i].tendon_stiffness > 0.0;
    motors_act_ = motors_act_ || motors_[i].acts();
    motor_step = std::min(motor_step, motors_[i].longest_step());
  }
  const auto step_for = [](double longest, double fastest) {
    return fastest > 0.0 ? std::min(longest, kStepOverTimeConstant / fastest) : longest;
  };
  calm_step_ = step_for(seconds(config_.max_step), rate);
  contact_step_ = config_.contact ? step_for(calm_step_, config_.contact->rate(mass)) : calm_step_;
  motor_step_ = motor_step;
  fastest_rate_ = std::max(rate, config_.contact ? config_.contact->rate(mass) : 0.0);
}

inline Vector3 Plant::tool_force(double s, const Look& at) const noexcept {
  Vector3 force = Vector3::Zero();
  if (config_.hand) force += config_.hand->pull(s, at.tool.p, at.tool.v);
  if (touching_ && config_.contact) {
    force += config_.contact->smooth_force(at.depth) * at.depth.normal;
  }
  const LoadTerms& load = config_.terms.load;
  if (load.has_grip()) {
    force += load.grip_stiffness * (grip_point_ - at.tool.p) - load.grip_damping * at.tool.v;
  }
  return force;
}

JointVector Plant::delivered(double dt, const JointVector& m) const noexcept {
  JointVector a = motors_act_ ? motor_torque_ : chain_.torque(dt);
  if (ripples_) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      a[axis] += wave_sum(config_.terms.actuation[i].ripple, m[axis]);
    }
  }
  return a;
}

/// Friction of a drive but for its dry part, which is an event's matter, in the present mode.
inline double Plant::smooth_friction(std::size_t i, double turn, double v) const noexcept {
  const JointFriction& friction = config_.terms.friction[i];
  double f = -v * (sliding_[i] == Sliding::backward ? friction.viscous_backward
                                                    : friction.viscous_forward);
  if (!peaks_ && !bristles_) return f;
  const auto direction = static_cast<double>(sliding_[i]);
  const double z = bristle_[static_cast<Eigen::Index>(i)];
  if (sliding_[i] == Sliding::stuck) return f - z;
  if (friction.stribeck_rise > 0.0) {
    const double x = v / friction.stribeck_velocity;
    f -= direction * friction.stribeck_rise * std::exp(-x * x);
  }
  if (friction.bristle.level > 0.0) {
    const double midway = (md_[static_cast<Eigen::Index>(i)] + v) / 2.0;
    const double bent = bend(friction.bristle, z, turn, midway, direction);
    f += bristle_torque(friction.bristle, bent, v, direction);
  }
  return f;
}

/// Torques on the drives that need neither link nor tool.
inline JointVector Plant::drive_torque(const Stage& stage) const noexcept {
  const JointVector& turn = splits_ ? stage.drive_turn : stage.turn;
  const JointVector& speed = splits_ ? stage.md : stage.qd;
  JointVector torque =
      ripples_ || motors_act_ ? delivered(stage.dt, m_ + turn) : chain_.torque(stage.dt);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    torque[axis] += disturbance_[axis] + smooth_friction(i, turn[axis], speed[axis]);
  }
  return torque;
}

/// The joints' inertia less that of the drives that move on their own.
RigidBody::Inertia Plant::effective(RigidBody::Inertia inertia) const noexcept {
  if (!splits_) return inertia;
  const std::array diagonal{&inertia.M11, &inertia.M22, &inertia.M33};
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (separate(i)) *diagonal[i] -= config_.terms.transmission[i].drive_inertia;
  }
  return inertia;
}

/// @param link, drive torques on either side; @param transmitted T where a transmission gives way
inline Plant::Rates Plant::accelerate_all(const RigidBody::Inertia& inertia,
                                          const JointVector& link,
                                          const JointVector& drive,
                                          const JointVector& transmitted) const noexcept {
  Rates rates;
  rates.drive = drive;
  if (!splits_) {
    const Acceleration motion = accelerate(inertia, config_.terms.friction, link + drive, sliding_);
    rates.qdd = motion.qdd;
    rates.mdd = motion.qdd;
    rates.hold = motion.hold;
    return rates;
  }
  JointVector net = link;
  std::array<JointFriction, kJoints> friction = config_.terms.friction;
  SlidingModes modes = sliding_;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    net[axis] += separate(i) ? transmitted[axis] : drive[axis];
    if (!separate(i)) continue;
    friction[i] = {};
    modes[i] = Sliding::forward;
  }
  const Acceleration motion = accelerate(effective(inertia), friction, net, modes);
  rates.qdd = motion.qdd;
  rates.mdd = motion.qdd;
  rates.hold = motion.hold;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!separate(i)) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    const JointFriction& dry = config_.terms.friction[i];
    const double torque = drive[axis] - transmitted[axis];
    const double J = config_.terms.transmission[i].drive_inertia;
    rates.hold[axis] = 0.0;
    if (sliding_[i] == Sliding::stuck) {
      rates.hold[axis] = torque;
      rates.mdd[axis] = 0.0;
    } else if (sliding_[i] == Sliding::forward) {
      rates.mdd[axis] = (torque - dry.dry_forward) / J;
    } else {
      rates.mdd[axis] = (torque + dry.dry_backward) / J;
    }
  }
  return rates;
}

/// Accelerations at the present posture turned by the stage's turns. `seen`, if given, holds the
/// tool and the surface already.
Plant::Rates Plant::rates(const Stage& stage,
                          const RigidBody::Angles& angles,
                          Look* seen) const noexcept {
  const RigidBody::Inertia inertia = body_.inertia(angles, stage.qd);
  const JointVector q = q_ + stage.turn;
  JointVector link = -inertia.bias;
  if (stopped_ != 0) link += stops_.torque(stopped_, q, stage.qd);
  if (springs_) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      link[axis] += config_.terms.spring_torque[i] - config_.terms.spring_stiffness[i] * q[axis];
    }
  }
  if (config_.hand || touching_ || config_.terms.load.has_grip()) {
    Look at;
    if (seen == nullptr) {
      at.tool = body_.tool(angles, stage.qd);
      if (touching_ && config_.contact) at.depth = config_.contact->depth(at.tool.p, at.tool.v);
      seen = &at;
    }
    link += body_.torque(angles, tool_force(s_ + stage.dt, *seen));
  }
  JointVector transmitted = JointVector::Zero();
  if (splits_) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Transmission& transmission = config_.terms.transmission[i];
      if (transmission.kind != Transmission::Kind::compliant) continue;
      const auto axis = static_cast<Eigen::Index>(i);
      transmitted[axis] = transmission.stiffness * (m_[axis] + stage.drive_turn[axis] - q[axis]) +
                          transmission.damping * (stage.md[axis] - stage.qd[axis]);
    }
  }
  return accelerate_all(inertia, link, drive_torque(stage), transmitted);
}

/// Everything at a state `dt` from now, in the present forms.
Plant::Look Plant::look(double dt, const Motion& at) const noexcept {
  Look seen;
  seen.angles = RigidBody::Angles{at.q};
  seen.tool = body_.tool(seen.angles, at.qd);
  if (config_.contact) seen.depth = config_.contact->depth(seen.tool.p, seen.tool.v);
  const Stage stage{.dt = dt, .turn = at.q - q_, .qd = at.qd, .drive_turn = at.m - m_, .md = at.md};
  seen.rates = rates(stage, seen.angles, &seen);
  return seen;
}

/// T of an axis that touches an end of its play, positive where that end pushes, N m.
double Plant::pressed(std::size_t i, const Look& look) const noexcept {
  const auto axis = static_cast<Eigen::Index>(i);
  const JointFriction& friction = config_.terms.friction[i];
  double T = look.rates.drive[axis];
  if (sliding_[i] == Sliding::stuck) {
    T -= look.rates.hold[axis];
  } else {
    T -= sliding_[i] == Sliding::forward ? friction.dry_forward : -friction.dry_backward;
    T -= config_.terms.transmission[i].drive_inertia * look.rates.qdd[axis];
  }
  return static_cast<double>(touch_[i]) * T;
}

/// Chooses what is touched and which way joints slide, from the state alone.
void Plant::choose_forms() noexcept {
  const Look at = look(0.0, {q_, qd_, m_, md_});
  touching_ = config_.contact && config_.contact->push_margin(at.depth) > 0.0;
  stopped_ = stops_.empty() ? 0 : stops_.pushing(q_, qd_);
  resolve_modes();
}

/// Moving drives slide their way; those at rest stick, or slide where they are pushed.
void Plant::resolve_modes() noexcept {
  std::array<JointFriction, kJoints> friction = config_.terms.friction;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const bool corner = friction[i].has_corner();
    sliding_[i] = md_[axis] < 0.0 && corner ? Sliding::backward : Sliding::forward;
    if (corner && md_[axis] == 0.0) {
      sliding_[i] = Sliding::stuck;  // so that the look below leaves out what depends on direction
      friction[i].dry_forward = friction[i].stick_forward();
      friction[i].dry_backward = friction[i].stick_backward();
    }
    if (separate(i)) friction[i] = {};
  }
  const Look at = look(0.0, {q_, qd_, m_, md_});
  JointVector net = JointVector::Zero();
  const RigidBody::Inertia inertia = effective(body_.inertia(at.angles, qd_));
  SlidingModes modes = sliding_;
  if (splits_) {
    // What each joint would feel free of its dry friction: M q̈ plus the friction that the look
    // held.
    for (std::size_t i = 0; i < kJoints; ++i) {
      if (!separate(i)) continue;
      const auto axis = static_cast<Eigen::Index>(i);
      if (sliding_[i] != Sliding::stuck) continue;
      const JointFriction& own = config_.terms.friction[i];
      const double torque = at.rates.hold[axis];
      if (torque > own.stick_forward()) sliding_[i] = Sliding::forward;
      if (torque < -own.stick_backward()) sliding_[i] = Sliding::backward;
      modes[i] = sliding_[i];
    }
  }
  net = {inertia.M11 * at.rates.qdd[0],
         inertia.M22 * at.rates.qdd[1] + inertia.M23 * at.rates.qdd[2],
         inertia.M33 * at.rates.qdd[2] + inertia.M23 * at.rates.qdd[1]};
  JointVector speed = md_;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (separate(i)) {
      speed[axis] = 1.0;  // its joint has no friction and takes part as it moves
      continue;
    }
    if (modes[i] == Sliding::stuck) net[axis] += at.rates.hold[axis];
    if (modes[i] == Sliding::forward) net[axis] += friction[i].dry_forward;
    if (modes[i] == Sliding::backward) net[axis] -= friction[i].dry_backward;
  }
  const SlidingModes joints = resolve_friction(inertia, friction, speed, net);
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!separate(i)) sliding_[i] = joints[i];
  }
  now_ = look(0.0, {q_, qd_, m_, md_});
  torque_is_new_ = false;
}

/// An end of play is hit: both sides go on together, and so do joints that they push along.
void Plant::collide(std::size_t i, signed char side) noexcept {
  const auto axis = static_cast<Eigen::Index>(i);
  const RigidBody::Angles angles{q_};
  const double J = config_.terms.transmission[i].drive_inertia;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const RigidBody::Inertia inertia = effective(body_.inertia(angles, qd_));
    const Matrix3 M = (Matrix3{} << inertia.M11, 0.0, 0.0, 0.0, inertia.M22, inertia.M23, 0.0,
                       inertia.M23, inertia.M33)
                          .finished();
    const JointVector response = M.inverse().col(axis);
    const double impulse = (md_[axis] - qd_[axis]) / (1.0 / J + response[axis]);
    // A joint whose play is closed comes along if that pushes its end, else it lets go.
    bool opened = false;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (j == i || touch_[j] == 0) continue;
      const double change = impulse * response[static_cast<Eigen::Index>(j)];
      if (-change * static_cast<double>(touch_[j]) >= 0.0) continue;
      touch_[j] = 0;
      opened = true;
    }
    if (opened) continue;
    qd_ += impulse * response;
    md_[axis] = qd_[axis];
    break;
  }
  touch_[i] = side;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto other = static_cast<Eigen::Index>(j);
    if (!separate(j)) md_[other] = qd_[other];
  }
}

/// Plays that are at an end: they collide, stay closed or open.
void Plant::close_plays() noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Transmission& transmission = config_.terms.transmission[i];
    if (transmission.kind != Transmission::Kind::play) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    const double off = m_[axis] - q_[axis];
    const signed char side = off > 0.0 ? 1 : -1;
    const bool at_end = std::abs(off) >= transmission.gap / 2.0 * (1.0 - 1e-12);
    if (touch_[i] != 0 || !at_end) continue;
    const double approach = static_cast<double>(side) * (md_[axis] - qd_[axis]);
    m_[axis] = q_[axis] + static_cast<double>(side) * transmission.gap / 2.0;
    if (approach > 0.0) {
      collide(i, side);
    } else if (approach == 0.0) {
      touch_[i] = side;
    }
  }
}

/// Chooses the forms of the equation anew.
void Plant::settle() noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const bool turned = static_cast<double>(sliding_[i]) * md_[axis] < 0.0;
    if (turned && config_.terms.friction[i].has_corner()) {
      md_[axis] = 0.0;
      if (!separate(i)) qd_[axis] = 0.0;
    }
  }
  if (splits_) close_plays();
  choose_forms();
  if (!splits_) return;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (touch_[i] == 0 || pressed(i, now_) >= 0.0) continue;
    touch_[i] = 0;
    choose_forms();
  }
}

/// Takes a new torque into account: it may set joints at rest in motion and lift drives off the
/// ends of their play, nothing else changes form.
void Plant::refresh() noexcept {
  if (shifted_) {
    shifted_ = false;
    choose_forms();
    return;
  }
  if (!torque_is_new_) return;
  torque_is_new_ = false;
  bool changes = splits_;
  for (std::size_t i = 0; i < kJoints; ++i) {
    changes = changes ||
              (config_.terms.friction[i].has_corner() && md_[static_cast<Eigen::Index>(i)] == 0.0);
  }
  if (changes) {
    settle();
  } else {
    now_ = look(0.0, {q_, qd_, m_, md_});
  }
}

JointVector Plant::qdd() noexcept {
  refresh();
  return now_.rates.qdd;
}

JointVector Plant::delivered_torque() noexcept {
  refresh();
  return delivered(0.0, m_);
}

const SlidingModes& Plant::sliding() noexcept {
  refresh();
  return sliding_;
}

Vector3 Plant::tool_acceleration() noexcept {
  refresh();
  return body_.tool_acceleration(now_.angles, qd_, now_.rates.qdd);
}

Plant::ToolForces Plant::tool_forces() noexcept {
  refresh();
  ToolForces forces;
  if (touching_ && config_.contact) {
    forces.contact = config_.contact->force(now_.depth) * now_.depth.normal;
  }
  const LoadTerms& load = config_.terms.load;
  if (load.has_grip() || load.grip_mass > 0.0) {
    forces.hand = load.grip_stiffness * (grip_point_ - now_.tool.p) -
                  load.grip_damping * now_.tool.v - load.grip_mass * tool_acceleration();
  }
  if (config_.hand) {
    forces.hand += config_.hand->pull(s_, now_.tool.p, now_.tool.v) -
                   config_.hand->config().mass_kg * tool_acceleration();
  }
  return forces;
}

double Plant::energy() noexcept {
  refresh();
  double sum = body_.energy(now_.angles, qd_) + stops_.stored_energy(q_);
  if (config_.contact) sum += config_.contact->stored_energy(now_.depth);
  if (config_.hand) {
    const Vector3 stretch = config_.hand->target(s_).p - now_.tool.p;
    sum += config_.hand->config().stiffness_N_per_m * stretch.squaredNorm() / 2.0;
  }
  const PlantTerms& terms = config_.terms;
  sum += terms.load.grip_stiffness * (grip_point_ - now_.tool.p).squaredNorm() / 2.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (terms.spring_stiffness[i] > 0.0) {
      const double stretch = q_[axis] - terms.spring_torque[i] / terms.spring_stiffness[i];
      sum += terms.spring_stiffness[i] * stretch * stretch / 2.0;
    }
    if (terms.friction[i].bristle.level > 0.0) {
      sum += bristle_[axis] * bristle_[axis] / (2.0 * terms.friction[i].bristle.stiffness);
    }
    const Transmission& transmission = terms.transmission[i];
    if (transmission.kind == Transmission::Kind::rigid) continue;
    const double twist = m_[axis] - q_[axis];
    sum += transmission.drive_inertia * (md_[axis] * md_[axis] - qd_[axis] * qd_[axis]) / 2.0 +
           transmission.stiffness * twist * twist / 2.0;
  }
  return sum;
}

}  // namespace teleop
