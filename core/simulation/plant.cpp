#include "core/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

constexpr double kEventTolerance = 1e-12;  // s
/// After so many events in one stretch of time the rest passes in steps of at most kCrowdedStep,
/// whose events are taken at their ends, so that time goes on whatever happens.
constexpr int kMaxEvents = 1000;
constexpr double kCrowdedStep = 2e-5;  // s
/// Share of the shortest time constant that a step may take: it errs 1e-5 of a vibration a step.
constexpr double kStepOverTimeConstant = 0.25;

/// A quantity over a step: its values and slopes at both ends.
struct Course {
  double value0 = 0.0;
  double slope0 = 0.0;
  double value1 = 0.0;
  double slope1 = 0.0;
};

/// Where inside a step a quantity that is positive at both ends dips below zero, if its cubic does.
std::optional<double> dip_of(double h, const Course& f) noexcept {
  if (f.slope0 >= 0.0 || f.slope1 <= 0.0 || f.value0 <= 0.0) return std::nullopt;
  const double u = f.slope0 / (f.slope0 - f.slope1);
  const double rise = f.value1 - f.value0;
  const double c2 = 3.0 * rise - h * (2.0 * f.slope0 + f.slope1);
  const double c3 = h * (f.slope0 + f.slope1) - 2.0 * rise;
  const double lowest = f.value0 + u * (h * f.slope0 + u * (c2 + u * c3));
  if (lowest >= 0.0) return std::nullopt;
  return u * h;
}

}  // namespace

Plant::Rates Plant::rates(const ArmModel& arm, const Config& config) noexcept {
  // Half of the inertia at home bounds it from below over the workspace.
  const auto& lumped = arm.lumped();
  const double l1 = arm.parameters().l1_m;
  const double l2 = arm.parameters().l2_m;
  const double mass = std::min(lumped.M22 / (l1 * l1), lumped.M33 / (l2 * l2)) / 2.0;
  const double inertia = std::min(lumped.M22, lumped.M33) / 2.0;
  Rates fastest{
      .always = config.hand ? config.hand->rate(mass) : 0.0,
      .contact = config.contact ? config.contact->rate(mass) : 0.0,
      .stops =
          std::max(std::sqrt(JointStops::kStiffness / inertia), JointStops::kDamping / inertia),
  };
  for (const JointFriction& friction : config.terms.friction) {
    fastest.always = std::max(
        {fastest.always, friction.viscous_forward / inertia, friction.viscous_backward / inertia});
  }
  return fastest;
}

Plant::Plant(const ArmModel& arm, const Config& config)
    : body_{arm, config.hand ? config.hand->config().mass_kg : 0.0},
      stops_{arm},
      config_{config},
      q_{config.q},
      qd_{config.qd} {
  expects(config.max_step.count() > 0, "the longest step of a plant is positive");
  expects(q_.allFinite() && qd_.allFinite(), "a plant starts from a finite state");
  const Rates fastest = rates(arm, config);
  const auto step_for = [](double longest, double rate) {
    return rate > 0.0 ? std::min(longest, kStepOverTimeConstant / rate) : longest;
  };
  calm_step_ = step_for(seconds(config.max_step), fastest.always);
  contact_step_ = step_for(calm_step_, fastest.contact);
  stop_step_ = step_for(calm_step_, fastest.stops);
  settle();
}

void Plant::set_torque(const JointVector& tau) noexcept {
  expects(tau.allFinite(), "motor torques are finite");
  if (tau == tau_) return;
  tau_ = tau;
  torque_is_new_ = true;
}

/// Torques that need neither tool nor hand.
inline JointVector Plant::smooth_torque(const JointVector& q,
                                        const JointVector& qd) const noexcept {
  JointVector torque = tau_;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const JointFriction& friction = config_.terms.friction[i];
    torque[joint] -= qd[joint] * (sliding_[i] == Sliding::backward ? friction.viscous_backward
                                                                   : friction.viscous_forward);
  }
  if (stopped_ != 0) torque += stops_.torque(stopped_, q, qd);
  return torque;
}

inline Vector3 Plant::tool_force(double s, const Look& at) const noexcept {
  Vector3 force = Vector3::Zero();
  if (config_.hand) force += config_.hand->pull(s, at.tool.p, at.tool.v);
  if (touching_ && config_.contact) {
    force += config_.contact->smooth_force(at.depth) * at.depth.normal;
  }
  return force;
}

template <bool kSettle>
Plant::Look Plant::look(double s, const JointVector& q, const JointVector& qd) noexcept {
  Look at;
  at.angles = RigidBody::Angles{q};
  const RigidBody::Inertia inertia = body_.inertia(at.angles, qd);
  at.tool = body_.tool(at.angles, qd);
  if (config_.contact) at.depth = config_.contact->depth(at.tool.p, at.tool.v);
  if constexpr (kSettle) {
    touching_ = config_.contact && config_.contact->push_margin(at.depth) > 0.0;
    stopped_ = config_.stops ? stops_.pushing(q, qd) : 0;
  }
  const auto net = [&]() noexcept -> JointVector {
    return smooth_torque(q, qd) + body_.torque(at.angles, tool_force(s, at)) - inertia.bias;
  };
  if constexpr (kSettle) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      sliding_[i] = qd[static_cast<Eigen::Index>(i)] < 0.0 && config_.terms.friction[i].has_corner()
                        ? Sliding::backward
                        : Sliding::forward;
    }
    sliding_ = resolve_friction(inertia, config_.terms.friction, qd, net());
  }
  at.motion = accelerate(inertia, config_.terms.friction, net(), sliding_);
  return at;
}

/// Acceleration at the present posture turned by `turn`: what a stage of a step needs of a look.
inline JointVector Plant::acceleration(double s,
                                       const JointVector& turn,
                                       const JointVector& qd) const noexcept {
  const RigidBody::Angles angles = now_.angles.turned(turn);
  const RigidBody::Inertia inertia = body_.inertia(angles, qd);
  JointVector net = smooth_torque(q_ + turn, qd) - inertia.bias;
  if (config_.hand || touching_) {
    Look at;
    at.tool = body_.tool(angles, qd);
    if (touching_ && config_.contact) at.depth = config_.contact->depth(at.tool.p, at.tool.v);
    net += body_.torque(angles, tool_force(s, at));
  }
  return accelerate(inertia, config_.terms.friction, net, sliding_).qdd;
}

/// Least of the quantities that are positive while the present forms of the equation hold.
double Plant::margin(const JointVector& q, const JointVector& qd, const Look& at) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointFriction& friction = config_.terms.friction[i];
    if (!friction.has_corner()) continue;
    const auto joint = static_cast<Eigen::Index>(i);
    if (sliding_[i] == Sliding::stuck) {
      least = std::min({least, friction.dry_forward - at.motion.hold[joint],
                        friction.dry_backward + at.motion.hold[joint]});
    } else {
      least = std::min(least, static_cast<double>(sliding_[i]) * qd[joint]);
    }
  }
  if (config_.contact) {
    const double push = config_.contact->push_margin(at.depth);
    least = std::min(least, touching_ ? push : -push);
  }
  if (config_.stops) least = std::min(least, stops_.margin(stopped_, q, qd));
  return least;
}

/// One step of Runge–Kutta from the present state; its first stage is the present look.
Plant::Trial Plant::step(double h) noexcept {
  const double half = h / 2.0;
  const JointVector& a1 = now_.motion.qdd;
  const JointVector v2 = qd_ + half * a1;
  const JointVector a2 = acceleration(s_ + half, half * qd_, v2);
  const JointVector v3 = qd_ + half * a2;
  const JointVector a3 = acceleration(s_ + half, half * v2, v3);
  const JointVector v4 = qd_ + h * a3;
  const JointVector a4 = acceleration(s_ + h, h * v3, v4);
  Trial end;
  end.q = q_ + h * (qd_ + h / 6.0 * (a1 + a2 + a3));
  end.qd = qd_ + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
  end.look = look<false>(s_ + h, end.q, end.qd);
  end.margin = margin(end.q, end.qd, end.look);
  return end;
}

/// Where a speed or the distance to the surface turns inside the step beyond its zero, if so.
std::optional<double> Plant::dip(double h, const Trial& end) const noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!config_.terms.friction[i].has_corner() || sliding_[i] == Sliding::stuck) continue;
    const auto joint = static_cast<Eigen::Index>(i);
    const auto sign = static_cast<double>(sliding_[i]);
    const Course speed{.value0 = sign * qd_[joint],
                       .slope0 = sign * now_.motion.qdd[joint],
                       .value1 = sign * end.qd[joint],
                       .slope1 = sign * end.look.motion.qdd[joint]};
    if (const auto where = dip_of(h, speed)) return where;
  }
  if (!config_.contact || touching_) return std::nullopt;
  return dip_of(h, {.value0 = -now_.depth.p,
                    .slope0 = -now_.depth.p_rate,
                    .value1 = -end.look.depth.p,
                    .slope1 = -end.look.depth.p_rate});
}

/// The end of the longest step after which the forms hold no more by less than the tolerance.
/// `end` is the trial after h, whose margin is negative; it becomes the one after the result.
double Plant::locate(double h, Trial& end) noexcept {
  double low = 0.0;
  double margin_low = margin(q_, qd_, now_);
  double high = h;
  double margin_high = end.margin;
  // A joint that just came loose starts on the very border: look for a place beyond it.
  while (margin_low <= 0.0 && high > kEventTolerance) {
    const Trial trial = step(high / 2.0);
    if (trial.margin > 0.0) {
      low = high / 2.0;
      margin_low = trial.margin;
    } else {
      high /= 2.0;
      margin_high = trial.margin;
      end = trial;
    }
  }
  // Regula falsi, the Illinois way: the end that stays twice counts half. Should that be slow,
  // halves.
  constexpr int kPatience = 20;
  constexpr double kGuard = kEventTolerance / 2.0;
  int last_side = 0;
  for (int i = 0; high - low > kEventTolerance; ++i) {
    const double guess = i < kPatience
                             ? (low * margin_high - high * margin_low) / (margin_high - margin_low)
                             : (low + high) / 2.0;
    const double x = std::clamp(guess, low + kGuard, high - kGuard);
    const Trial trial = step(x);
    if (trial.margin < 0.0) {
      high = x;
      margin_high = trial.margin;
      end = trial;
      if (last_side < 0) margin_low /= 2.0;
      last_side = -1;
    } else {
      low = x;
      margin_low = trial.margin;
      if (last_side > 0) margin_high /= 2.0;
      last_side = 1;
    }
  }
  return high;
}

double Plant::longest_step() const noexcept {
  double longest = calm_step_;
  if (touching_) longest = std::min(longest, contact_step_);
  if (stopped_ != 0) longest = std::min(longest, stop_step_);
  return longest;
}

void Plant::commit(double h, const Trial& end, EncoderEdges* edges) noexcept {
  if (edges != nullptr) {
    edges->observe({.start_s = seconds(time_) + (s_ - seconds(since_knot_)),
                    .duration_s = h,
                    .q0 = q_,
                    .qd0 = qd_,
                    .q1 = end.q,
                    .qd1 = end.qd});
  }
  q_ = end.q;
  qd_ = end.qd;
  now_ = end.look;
  s_ += h;
}

/// Chooses the forms of the equation from the state alone.
void Plant::settle() noexcept {
  now_ = look<true>(s_, q_, qd_);
  torque_is_new_ = false;
}

/// Takes a new torque into account: it may set joints at rest in motion, nothing else changes form.
void Plant::refresh() noexcept {
  if (!torque_is_new_) return;
  torque_is_new_ = false;
  bool at_rest = false;
  for (std::size_t i = 0; i < kJoints; ++i) {
    at_rest = at_rest ||
              (config_.terms.friction[i].has_corner() && qd_[static_cast<Eigen::Index>(i)] == 0.0);
  }
  now_ = at_rest ? look<true>(s_, q_, qd_) : look<false>(s_, q_, qd_);
}

void Plant::integrate(double length, EncoderEdges* edges) noexcept {
  double done = 0.0;
  int events = 0;
  while (done < length) {
    const double left = length - done;
    const auto steps = static_cast<int>(left / longest_step() + 0.999'999);
    double h = steps <= 1 ? left : left / static_cast<double>(steps);
    const bool crowded = events >= kMaxEvents;
    if (crowded) h = std::min(h, kCrowdedStep);

    Trial end = step(h);
    if (const auto where = end.margin >= 0.0 && !crowded ? dip(h, end) : std::nullopt) {
      const Trial inside = step(*where);
      if (inside.margin < 0.0) {
        end = inside;
        h = *where;
      }
    }
    const bool event = end.margin < 0.0;
    if (event && !crowded) h = locate(h, end);
    commit(h, end, edges);
    done += h;
    if (left - h <= 0.0) done = length;
    if (!event) continue;

    ++events;
    ++events_;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      const bool turned = static_cast<double>(sliding_[i]) * qd_[joint] < 0.0;
      if (turned && config_.terms.friction[i].has_corner()) qd_[joint] = 0.0;
    }
    settle();
  }
}

/// Friction holds every joint and nothing that acts depends on time.
bool Plant::rests() const noexcept {
  constexpr SlidingModes kAllStuck{Sliding::stuck, Sliding::stuck, Sliding::stuck};
  return !config_.hand && sliding_ == kAllStuck;
}

void Plant::advance(Duration span, EncoderEdges* edges) noexcept {
  refresh();
  if (rests()) {
    time_ += span;
    return;
  }
  while (span.count() > 0) {
    const Duration part = config_.hand ? std::min(span, kKnotPeriod - since_knot_) : span;
    s_ = seconds(since_knot_);
    integrate(seconds(part), edges);
    span -= part;
    time_ += part;
    since_knot_ = config_.hand ? since_knot_ + part : Duration{0};
    if (config_.hand && since_knot_ == kKnotPeriod) {
      config_.hand->next_interval();
      since_knot_ = Duration{0};
    }
    s_ = seconds(since_knot_);
  }
}

JointVector Plant::qdd() noexcept {
  refresh();
  return now_.motion.qdd;
}

const SlidingModes& Plant::sliding() noexcept {
  refresh();
  return sliding_;
}

Plant::ToolForces Plant::tool_forces() noexcept {
  refresh();
  ToolForces forces;
  if (touching_ && config_.contact) {
    forces.contact = config_.contact->force(now_.depth) * now_.depth.normal;
  }
  if (config_.hand) {
    forces.hand =
        config_.hand->pull(s_, now_.tool.p, now_.tool.v) -
        config_.hand->config().mass_kg * body_.tool_acceleration(now_.angles, qd_, now_.motion.qdd);
  }
  return forces;
}

double Plant::energy() noexcept {
  refresh();
  double sum = body_.energy(now_.angles, qd_);
  if (config_.stops) sum += stops_.stored_energy(q_);
  if (config_.contact) sum += config_.contact->stored_energy(now_.depth);
  if (config_.hand) {
    const Vector3 stretch = config_.hand->target(s_).p - now_.tool.p;
    sum += config_.hand->config().stiffness_N_per_m * stretch.squaredNorm() / 2.0;
  }
  return sum;
}

}  // namespace teleop
