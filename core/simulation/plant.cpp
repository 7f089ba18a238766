#include "core/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/contract.hpp"
#include "core/simulation/bristle.hpp"

namespace teleop {
namespace {

constexpr double kEventTolerance = 1e-12;  // s
/// After so many events in one stretch of time the rest passes in steps of at most kCrowdedStep,
/// whose events are taken at their ends, so that time goes on whatever happens.
constexpr int kMaxEvents = 1000;
constexpr double kCrowdedStep = 2e-5;   // s
constexpr double kShortestStep = 1e-6;  // s, that a narrow friction peak asks for

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

void Plant::set_torque(const JointVector& tau) noexcept {
  expects(tau.allFinite(), "motor torques are finite");
  if (tau == tau_ && commanded_) return;
  commanded_ = true;
  tau_ = tau;
  chain_.command(tau);
  torque_is_new_ = true;
}

void Plant::set_disturbance(const JointVector& torque) noexcept {
  expects(torque.allFinite(), "disturbances are finite");
  if (torque == disturbance_) return;
  disturbance_ = torque;
  torque_is_new_ = true;
}

void Plant::shift(const Shift& by) noexcept {
  expects(by.q.allFinite() && by.qd.allFinite() && by.m.allFinite() && by.md.allFinite(),
          "a shift is finite");
  shifted_ = true;
  q_ += by.q;
  qd_ += by.qd;
  if (!splits_) {
    m_ = q_;
    md_ = qd_;
    return;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (!separate(i)) {
      m_[axis] += by.q[axis];
      md_[axis] = qd_[axis];
      continue;
    }
    m_[axis] += by.m[axis];
    md_[axis] += by.md[axis];
    const Transmission& transmission = config_.terms.transmission[i];
    if (transmission.kind != Transmission::Kind::play) continue;
    const double room = transmission.gap / 2.0;
    q_[axis] = std::clamp(q_[axis], m_[axis] - room, m_[axis] + room);
  }
}

/// One step of Runge–Kutta from the present state; its first stage is the present look.
Plant::Trial Plant::step(double h) noexcept {
  const double half = h / 2.0;
  const Rates& a1 = now_.rates;
  const auto at = [&](const Stage& stage) noexcept {
    return rates(stage, now_.angles.turned(stage.turn), nullptr);
  };
  Stage stage{.dt = half, .turn = half * qd_, .qd = qd_ + half * a1.qdd};
  if (splits_) {
    stage.drive_turn = half * md_;
    stage.md = md_ + half * a1.mdd;
  }
  const Rates a2 = at(stage);
  const JointVector v2 = stage.qd;
  const JointVector w2 = stage.md;
  stage.turn = half * v2;
  stage.qd = qd_ + half * a2.qdd;
  if (splits_) {
    stage.drive_turn = half * w2;
    stage.md = md_ + half * a2.mdd;
  }
  const Rates a3 = at(stage);
  const JointVector v3 = stage.qd;
  const JointVector w3 = stage.md;
  stage.dt = h;
  stage.turn = h * v3;
  stage.qd = qd_ + h * a3.qdd;
  if (splits_) {
    stage.drive_turn = h * w3;
    stage.md = md_ + h * a3.mdd;
  }
  const Rates a4 = at(stage);

  Trial end;
  end.at.q = q_ + h * (qd_ + h / 6.0 * (a1.qdd + a2.qdd + a3.qdd));
  end.at.qd = qd_ + h / 6.0 * (a1.qdd + 2.0 * (a2.qdd + a3.qdd) + a4.qdd);
  end.at.m = end.at.q;
  end.at.md = end.at.qd;
  if (splits_) {
    const JointVector m = m_ + h * (md_ + h / 6.0 * (a1.mdd + a2.mdd + a3.mdd));
    const JointVector md = md_ + h / 6.0 * (a1.mdd + 2.0 * (a2.mdd + a3.mdd) + a4.mdd);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      if (separate(i)) {
        end.at.m[axis] = m[axis];
        end.at.md[axis] = md[axis];
      } else if (touch_[i] != 0) {
        end.at.m[axis] += static_cast<double>(touch_[i]) * config_.terms.transmission[i].gap / 2.0;
      }
    }
  }
  end.look = look(h, end.at);
  end.margin = margin(end.at, end.look);
  return end;
}

/// Least of the quantities that are positive while the present forms of the equation hold.
double Plant::margin(const Motion& at, const Look& look) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const JointFriction& friction = config_.terms.friction[i];
    if (friction.has_corner()) {
      if (sliding_[i] == Sliding::stuck) {
        least = std::min({least, friction.stick_forward() - look.rates.hold[axis],
                          friction.stick_backward() + look.rates.hold[axis]});
      } else {
        least = std::min(least, static_cast<double>(sliding_[i]) * at.md[axis]);
      }
    }
    const Transmission& transmission = config_.terms.transmission[i];
    if (transmission.kind != Transmission::Kind::play) continue;
    least =
        std::min(least, touch_[i] == 0 ? transmission.gap / 2.0 - std::abs(at.m[axis] - at.q[axis])
                                       : pressed(i, look));
  }
  if (config_.contact) {
    const double push = config_.contact->push_margin(look.depth);
    least = std::min(least, touching_ ? push : -push);
  }
  if (!stops_.empty()) least = std::min(least, stops_.margin(stopped_, at.q, at.qd));
  return least;
}

/// Where a speed, a play or the distance to the surface turns inside the step beyond its zero, if
/// so.
std::optional<double> Plant::dip(double h, const Trial& end) const noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Transmission& transmission = config_.terms.transmission[i];
    if (transmission.kind == Transmission::Kind::play && touch_[i] == 0) {
      for (const double side : {-1.0, 1.0}) {
        const Course room{
            .value0 = transmission.gap / 2.0 - side * (m_[axis] - q_[axis]),
            .slope0 = side * (qd_[axis] - md_[axis]),
            .value1 = transmission.gap / 2.0 - side * (end.at.m[axis] - end.at.q[axis]),
            .slope1 = side * (end.at.qd[axis] - end.at.md[axis])};
        if (const auto where = dip_of(h, room)) return where;
      }
    }
    if (!config_.terms.friction[i].has_corner() || sliding_[i] == Sliding::stuck) continue;
    const auto sign = static_cast<double>(sliding_[i]);
    const Course speed{.value0 = sign * md_[axis],
                       .slope0 = sign * now_.rates.mdd[axis],
                       .value1 = sign * end.at.md[axis],
                       .slope1 = sign * end.look.rates.mdd[axis]};
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
  double margin_low = margin({q_, qd_, m_, md_}, now_);
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
  double longest = motors_act_ ? std::min(calm_step_, motor_step_) : calm_step_;
  if (touching_) longest = std::min(longest, contact_step_);
  if (stopped_ != 0) {
    longest = std::min(longest, kStepOverTimeConstant / stops_.fastest(stopped_, inertia_));
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    // The peak of Stribeck's curve is narrow: steps shrink as the speed comes near it.
    const JointFriction& friction = config_.terms.friction[i];
    const bool peak =
        friction.stribeck_rise > 0.0 || friction.bristle.static_level > friction.bristle.level;
    if (!peak || sliding_[i] == Sliding::stuck) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    const double width = friction.stribeck_rise > 0.0 ? friction.stribeck_velocity
                                                      : friction.bristle.stribeck_velocity;
    const double away = std::max(std::abs(md_[axis]) - 3.0 * width, kStepOverTimeConstant * width);
    const double pace = std::abs(now_.rates.mdd[axis]);
    if (pace * longest > away) longest = std::max(away / pace, kShortestStep);
  }
  return longest;
}

void Plant::observe(double h, const Motion& end, Sensing* sensing) noexcept {
  if (sensing == nullptr) return;
  sensing->observe({.start_s = seconds(time_) + (s_ - seconds(since_knot_)),
                    .duration_s = h,
                    .q0 = m_,
                    .qd0 = md_,
                    .q1 = end.m,
                    .qd1 = end.md},
                   tendons_ ? delivered(h, end.m) : JointVector::Zero());
}

void Plant::commit(double h, const Trial& end, Sensing* sensing) noexcept {
  observe(h, end.at, sensing);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const JointFriction::Bristle& bristle = config_.terms.friction[i].bristle;
    if (bristle.level <= 0.0 || sliding_[i] == Sliding::stuck) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    const double midway = (md_[axis] + end.at.md[axis]) / 2.0;
    bristle_[axis] = bend(bristle, bristle_[axis], end.at.m[axis] - m_[axis], midway,
                          static_cast<double>(sliding_[i]));
  }
  q_ = end.at.q;
  qd_ = end.at.qd;
  m_ = end.at.m;
  md_ = end.at.md;
  now_ = end.look;
  pass(h);
}

/// Time goes by for everything that is not the arm itself.
void Plant::pass(double dt) noexcept {
  const double change = chain_.next_change();
  chain_.advance(dt);
  s_ += dt;
  if (change - dt <= kEventTolerance) torque_is_new_ = true;
}

void Plant::run_motors(double h) noexcept {
  const JointVector demand = chain_.torque(h / 2.0);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double speed = md_[axis] + h / 2.0 * now_.rates.mdd[axis];
    motor_torque_[axis] = motors_[i].step(demand[axis], speed, m_[axis] + h / 2.0 * md_[axis], h);
  }
  torque_is_new_ = true;
  refresh();
}

void Plant::integrate(double length, Sensing* sensing) noexcept {
  double done = 0.0;
  int events = 0;
  while (done < length) {
    refresh();
    const double left = length - done;
    const double piece = std::min(left, chain_.next_change());
    const auto steps = static_cast<int>(piece / longest_step() + 0.999'999);
    double h = steps <= 1 ? piece : piece / static_cast<double>(steps);
    const bool crowded = events >= kMaxEvents;
    if (crowded) h = std::min(h, kCrowdedStep);
    const std::array<Motor, kJoints> motors_before = motors_;
    if (motors_act_) run_motors(h);

    Trial end = step(h);
    if (const auto where = end.margin >= 0.0 && !crowded ? dip(h, end) : std::nullopt) {
      const Trial inside = step(*where);
      if (inside.margin < 0.0) {
        end = inside;
        h = *where;
      }
    }
    const bool event = end.margin < 0.0;
    if (event && !crowded) {
      h = locate(h, end);
      if (motors_act_) {  // their currents go no further than the arm
        motors_ = motors_before;
        run_motors(h);
      }
    }
    commit(h, end, sensing);
    done += h;
    if (left - h <= 0.0) done = length;
    if (!event) continue;

    ++events;
    ++events_;
    settle();
  }
}

/// Friction holds every joint and nothing that acts depends on time.
bool Plant::rests() const noexcept {
  constexpr SlidingModes kAllStuck{Sliding::stuck, Sliding::stuck, Sliding::stuck};
  return !config_.hand && !splits_ && !motors_act_ && sliding_ == kAllStuck && chain_.constant() &&
         std::isinf(chain_.next_change());
}

void Plant::advance(Duration span, Sensing* sensing) noexcept {
  refresh();
  if (rests()) {
    chain_.advance(seconds(span));
    time_ += span;
    if (sensing != nullptr) sensing->pass(seconds(time_));
    return;
  }
  while (span.count() > 0) {
    const Duration part = config_.hand ? std::min(span, kKnotPeriod - since_knot_) : span;
    s_ = seconds(since_knot_);
    integrate(seconds(part), sensing);
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

}  // namespace teleop
