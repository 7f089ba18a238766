#include "scenarios/concealed/plant.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "scenarios/concealed/body.hpp"

namespace teleop::concealed {
namespace {

constexpr int kSweeps = 50;
constexpr double kSettled = 1e-13;  // rad/s
const JointVector hand_posture{0.0, 0.40, 0.25};

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

JointVector tip(const PlantLaw& law, const JointVector& q) {
  const double r = law.l1_m * std::cos(q[1]) + law.l2_m * std::sin(q[2]);
  return {std::sin(q[0]) * r, law.l2_m - law.l2_m * std::cos(q[2]) + law.l1_m * std::sin(q[1]),
          -law.l1_m + std::cos(q[0]) * r};
}

/// Dahl's bristle after a displacement: exact, as its slope is linear in it.
double bent(const FrictionLaw& law, double z, double displacement) {
  const double end = std::copysign(law.dahl_level, displacement);
  return end + (z - end) * std::exp(-law.dahl_stiffness * std::abs(displacement) / law.dahl_level);
}

/// Wall, springs and hysteresis of one link, N m.
double own_torque(const LinkLaw& law, double q, double v, double loading) {
  double torque = -law.spring * (q - law.rest);
  const double depth = law.wall_side * (q - law.wall_location);
  if (law.wall_stiffness > 0.0 && depth > 0.0) {
    const double push = law.wall_stiffness * depth + law.wall_damping * law.wall_side * v;
    torque -= law.wall_side * std::max(0.0, push);
  }
  if (law.loading_spring > 0.0) {
    const double stretch = q - law.loading_rest;
    const double loaded = loading * std::copysign(1.0, stretch);
    torque -= law.loading_spring * stretch * (1.0 + law.loading * loaded);
  }
  return torque;
}

std::array<Delivery, kJoints> deliveries(const PlantLaw& law, double period) {
  return {Delivery{law.axes[0].actuation, period}, Delivery{law.axes[1].actuation, period},
          Delivery{law.axes[2].actuation, period}};
}

}  // namespace

Plant::Plant(const PlantLaw& law, const JointVector& q, const JointVector& v, int substeps)
    : law_{law},
      period_{1e-3 * law.time_ratio},
      h_{period_ / substeps},
      substeps_{substeps},
      delivery_{deliveries(law, period_)},
      hand_point_{tip(law, hand_posture)},
      now_{.q = q, .v = v, .m = q, .w = v},
      absorber_{q},
      absorber_rate_{v},
      start_m_{q},
      start_w_{v} {
  expects(substeps >= 2 && substeps % 2 == 0, "a sample period has an even number of steps");
  double longest = 0.0;
  for (const AxisLaw& axis : law_.axes) {
    set_valued_ = set_valued_ || axis.friction.dry() || axis.transmission.play;
    longest = std::max({longest, axis.reading.delay, axis.reading.jitter > 0.0 ? period_ : 0.0});
  }
  if (longest > 0.0) {
    history_.resize(static_cast<std::size_t>(std::ceil(longest / h_)) + 3);
    for (std::size_t back = 0; back < history_.size(); ++back) {
      history_[(history_.size() - back) % history_.size()] =
          start_m_ - static_cast<double>(back) * h_ * start_w_;
    }
  }
}

void Plant::command(const JointVector& u) {
  command_ = u;
  for (std::size_t i = 0; i < kJoints; ++i) {
    delivery_.at(i).command(u[at(i)]);
  }
}

void Plant::advance_half(const JointVector& disturbance) {
  for (int k = 0; k < substeps_ / 2; ++k) {
    step(disturbance);
  }
}

void Plant::drive_torques(const Motion& middle, const JointVector& disturbance) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    const AxisLaw& axis = law_.axes[i];
    const ActuationLaw& actuation = axis.actuation;
    double a = delivery_[i].mean(t_, h_) + actuation.bias + actuation.ripple.at(middle.m[k]);
    for (std::size_t j = 0; j < kJoints; ++j) {
      a += actuation.coupling[j] * command_[at(j)];
    }
    double f = axis.friction.smooth(middle.w[k]);
    if (axis.friction.dahl_level > 0.0) {
      f -= bent(axis.friction, bristle_[k], middle.m[k] - now_.m[k]);
    }
    last_.delivered[k] = a;
    last_.friction[k] = f;
    drive_torque_[k] = a + f + disturbance[k];
    if (set_valued_) {
      levels_[i] = axis.friction.levels(t_ + h_ / 2.0, middle.m[k], middle.w[k]);
    }
  }
}

JointVector Plant::hand_torque(const Motion& middle) const noexcept {
  const JointVector& q = middle.q;
  const double c1 = std::cos(q[0]);
  const double s1 = std::sin(q[0]);
  const double c2 = std::cos(q[1]);
  const double s2 = std::sin(q[1]);
  const double c3 = std::cos(q[2]);
  const double s3 = std::sin(q[2]);
  const double r = law_.l1_m * c2 + law_.l2_m * s3;
  JointMatrix J;
  J << c1 * r, -law_.l1_m * s1 * s2, law_.l2_m * s1 * c3,  //
      0.0, law_.l1_m * c2, law_.l2_m * s3,                 //
      -s1 * r, -law_.l1_m * c1 * s2, law_.l2_m * c1 * c3;
  const JointVector force =
      -law_.hand_stiffness * (tip(law_, q) - hand_point_) - law_.hand_damping * (J * middle.v);
  return J.transpose() * force;
}

JointVector Plant::link_torques(const Body& body, const Motion& middle) noexcept {
  JointVector torque = -body.bias(law_, middle.q, middle.v);
  if (law_.hand_stiffness > 0.0 || law_.hand_damping > 0.0) torque += hand_torque(middle);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    const AxisLaw& axis = law_.axes[i];
    const LinkLaw& link = axis.link;
    torque[k] += own_torque(link, middle.q[k], middle.v[k], loading_[k]);
    torque[k] += link.cross.at(middle.q[at(link.cross_from)]);
    if (link.absorber > 0.0) {
      const double x = absorber_[k] + h_ / 2.0 * absorber_rate_[k];
      torque[k] += link.absorber_stiffness * (x - middle.q[k]) +
                   link.absorber_damping * (absorber_rate_[k] - middle.v[k]);
    }
    const TransmissionLaw& transmission = axis.transmission;
    if (!transmission.split) {
      torque[k] += drive_torque_[k];
    } else if (!transmission.play) {
      const double T = transmission.stiffness * (middle.m[k] - middle.q[k]) +
                       transmission.damping * (middle.w[k] - middle.v[k]);
      drive_torque_[k] -= T;
      torque[k] += T;
    }
  }
  return torque;
}

bool Plant::project_friction(const Body& body, std::size_t i, Motion& end) noexcept {
  const auto k = at(i);
  const AxisLaw& axis = law_.axes[i];
  const JointVector column = body.column(i);
  const bool split = axis.transmission.split;
  const double mobility = split ? 1.0 / axis.transmission.rotor : column[k];
  const double wanted = friction_impulse_[k] - end.w[k] / mobility;
  const double p = std::clamp(wanted, -h_ * levels_[i].forward, h_ * levels_[i].backward);
  const double change = p - friction_impulse_[k];
  friction_impulse_[k] = p;
  stuck_[i] = p == wanted;
  if (split) {
    end.w[k] += change * mobility;
  } else {
    end.v += change * column;
    end.w += change * column;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (law_.axes[j].transmission.split) end.w[at(j)] -= change * column[at(j)];
    }
  }
  return std::abs(change) * mobility > kSettled;
}

bool Plant::project_play(const Body& body, std::size_t i, Motion& end) noexcept {
  const auto k = at(i);
  const JointVector column = body.column(i);
  const double per_rotor = 1.0 / law_.axes[i].transmission.rotor;
  const double side = closed_[i];
  const double mobility = per_rotor + column[k];
  const double impulse = std::max(0.0, play_impulse_[k] + side * (end.w[k] - end.v[k]) / mobility);
  const double change = impulse - play_impulse_[k];
  play_impulse_[k] = impulse;
  end.v += side * change * column;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!law_.axes[j].transmission.split) end.w[at(j)] = end.v[at(j)];
  }
  end.w[k] -= side * change * per_rotor;
  return std::abs(change) * mobility > kSettled;
}

void Plant::project(const Body& body, const Motion& middle, Motion& end) {
  friction_impulse_.setZero();
  play_impulse_.setZero();
  std::array<bool, kJoints> dry{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    dry[i] = levels_[i].forward > 0.0 || levels_[i].backward > 0.0;
    stuck_[i] = false;
    closed_[i] = 0;
    const TransmissionLaw& transmission = law_.axes[i].transmission;
    if (!transmission.play) continue;
    const double opening = middle.m[k] - middle.q[k] + h_ / 2.0 * (end.w[k] - end.v[k]);
    if (std::abs(opening) >= transmission.gap / 2.0) closed_[i] = opening > 0.0 ? 1 : -1;
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool moved = false;
    for (std::size_t i = 0; i < kJoints; ++i) {
      if (dry[i]) moved = project_friction(body, i, end) || moved;
      if (closed_[i] != 0) moved = project_play(body, i, end) || moved;
    }
    if (!moved) break;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!stuck_[i]) continue;
    end.w[at(i)] = 0.0;
    if (!law_.axes[i].transmission.split) end.v[at(i)] = 0.0;
  }
}

void Plant::move_memory(const Motion& middle) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    const AxisLaw& axis = law_.axes[i];
    if (axis.link.loading > 0.0) {
      const double turned = h_ * middle.v[k] / axis.link.loading_width;
      loading_[k] = std::clamp(loading_[k] + turned, -1.0, 1.0);
    }
    if (axis.link.absorber > 0.0) {
      const double x = absorber_[k] + h_ / 2.0 * absorber_rate_[k];
      const double pull = axis.link.absorber_stiffness * (middle.q[k] - x) +
                          axis.link.absorber_damping * (middle.v[k] - absorber_rate_[k]);
      absorber_rate_[k] += h_ * pull / axis.link.absorber;
      absorber_[k] = x + h_ / 2.0 * absorber_rate_[k];
    }
  }
}

void Plant::arrive(const Motion& middle, Motion& end, bool impact) noexcept {
  end.q = middle.q + h_ / 2.0 * end.v;
  end.m = middle.m + h_ / 2.0 * end.w;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    const AxisLaw& axis = law_.axes[i];
    if (!axis.transmission.split) {
      end.m[k] = end.q[k];
    } else if (axis.transmission.play) {
      const double half = axis.transmission.gap / 2.0;
      end.m[k] = end.q[k] + std::clamp(end.m[k] - end.q[k], -half, half);
    }
    if (stuck_[i] || (impact && closed_[i] != 0)) {
      drive_rate_[k] = 0.0;
      link_rate_[k] = axis.transmission.split ? link_rate_[k] : 0.0;
    }
    if (axis.friction.dahl_level > 0.0) {
      const double half_way = bent(axis.friction, bristle_[k], middle.m[k] - now_.m[k]);
      bristle_[k] = bent(axis.friction, half_way, end.m[k] - middle.m[k]);
    }
  }
}

void Plant::step(const JointVector& disturbance) {
  const Motion middle{.q = now_.q + h_ / 2.0 * now_.v,
                      .v = now_.v + h_ / 2.0 * link_rate_,
                      .m = now_.m + h_ / 2.0 * now_.w,
                      .w = now_.w + h_ / 2.0 * drive_rate_};
  drive_torques(middle, disturbance);
  const Body body{law_, middle.q};
  const JointVector link = body.solve(link_torques(body, middle));
  JointVector drive = link;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const TransmissionLaw& transmission = law_.axes[i].transmission;
    if (transmission.split) drive[at(i)] = drive_torque_[at(i)] / transmission.rotor;
  }
  Motion end{.q = now_.q, .v = now_.v + h_ * link, .m = now_.m, .w = now_.w + h_ * drive};
  if (set_valued_) {
    project(body, middle, end);
    last_.friction += friction_impulse_ / h_;
  }
  move_memory(middle);
  last_.at = middle;
  last_.t = t_ + h_ / 2.0;
  last_.link_acceleration = (end.v - now_.v) / h_;
  last_.drive_acceleration = (end.w - now_.w) / h_;
  // An impact is no acceleration to go on with.
  const bool impact = play_impulse_.maxCoeff() > 0.0;
  link_rate_ = impact ? link : last_.link_acceleration;
  drive_rate_ = impact ? drive : last_.drive_acceleration;
  arrive(middle, end, impact);
  now_ = end;
  t_ += h_;
  if (!history_.empty()) {
    newest_ = (newest_ + 1) % history_.size();
    history_[newest_] = now_.m;
  }
}

JointVector Plant::past(double ago) const noexcept {
  if (ago <= 0.0 || history_.empty()) return now_.m;
  const double steps = ago / h_;
  const auto whole = std::min(static_cast<std::size_t>(steps), history_.size() - 2);
  const double part = steps - static_cast<double>(whole);
  const JointVector& younger = history_[(newest_ + history_.size() - whole) % history_.size()];
  const JointVector& older = history_[(newest_ + history_.size() - whole - 1) % history_.size()];
  return younger + part * (older - younger);
}

JointVector Plant::reading(double late) const {
  JointVector y = JointVector::Zero();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const ReadingLaw& law = law_.axes[i].reading;
    const double m = past(law.delay + late)[at(i)];
    y[at(i)] = law.scale * m + law.eccentricity.at(m);
  }
  return y;
}

void Plant::correct(const JointVector& by_q, const JointVector& by_v) {
  now_.m += by_q;
  now_.w += by_v;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    if (open(i)) {
      const double half = law_.axes[i].transmission.gap / 2.0;
      now_.q[k] = std::clamp(now_.q[k], now_.m[k] - half, now_.m[k] + half);
    } else {
      now_.q[k] += by_q[k];
      now_.v[k] += by_v[k];
    }
  }
  absorber_ += by_q;
  absorber_rate_ += by_v;
  for (JointVector& m : history_) {
    m += by_q;
  }
}

double Plant::energy() const noexcept {
  double sum = Body{law_, now_.q}.energy(law_, now_.q, now_.v);
  sum += law_.hand_stiffness * (tip(law_, now_.q) - hand_point_).squaredNorm() / 2.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = at(i);
    const LinkLaw& link = law_.axes[i].link;
    const TransmissionLaw& transmission = law_.axes[i].transmission;
    const double twist = now_.m[k] - now_.q[k];
    const double stretch = now_.q[k] - link.rest;
    const double depth = std::max(0.0, link.wall_side * (now_.q[k] - link.wall_location));
    const double hung = absorber_[k] - now_.q[k];
    sum += (transmission.rotor * now_.w[k] * now_.w[k] + transmission.stiffness * twist * twist +
            link.spring * stretch * stretch + link.wall_stiffness * depth * depth +
            link.absorber * absorber_rate_[k] * absorber_rate_[k] +
            link.absorber_stiffness * hung * hung) /
           2.0;
    const FrictionLaw& friction = law_.axes[i].friction;
    if (friction.dahl_level > 0.0) {
      sum += bristle_[k] * bristle_[k] / (2.0 * friction.dahl_stiffness);
    }
  }
  return sum;
}

}  // namespace teleop::concealed
