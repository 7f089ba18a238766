#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// The joint stops, the coupled stops of the parallelogram and walls in single joints as springs
/// and dampers that push and never pull: with p the angle past a stop, the torque back is max(0, k
/// p + d ṗ).
///
/// Assumed for the arm's own stops: k so stiff that the motors' full torque presses a stop in by
/// less than 0.4 mrad; d about half of critical with a joint's inertia, so that the arm rebounds
/// little. Loop: allocation-free, noexcept.
class JointStops {
 public:
  static constexpr double kStiffness = 5000.0;  ///< k of the arm's own stops, N m/rad
  static constexpr double kDamping = 2.5;       ///< d of them, N m s/rad

  /// Which of them push, a bit each.
  using Set = std::uint32_t;

  /// @param stops whether the arm has its own
  JointStops(const ArmModel& arm, bool stops, const ShortList<JointWall, 6>& walls) noexcept {
    const ArmParameters& limits = arm.parameters();
    if (stops) {
      for (std::size_t i = 0; i < kJoints; ++i) {
        add({.plus = i, .sign = -1.0, .limit = -limits.lower_limit_rad.at(i)});
        add({.plus = i, .sign = 1.0, .limit = limits.upper_limit_rad.at(i)});
      }
      add({.plus = 1, .minus = 2, .limit = limits.max_q2_minus_q3_rad});
      add({.plus = 2, .minus = 1, .limit = limits.max_q3_minus_q2_rad});
    }
    for (const JointWall& wall : walls) {
      add({.plus = wall.axis,
           .sign = wall.side,
           .limit = wall.side * wall.location,
           .k = wall.stiffness,
           .d = wall.damping});
    }
  }

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

  [[nodiscard]] Set pushing(const JointVector& q, const JointVector& qd) const noexcept {
    Set set = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      if (push_margin(stops_[i], q, qd) > 0.0) set |= Set{1} << i;
    }
    return set;
  }

  /// Positive while exactly the stops of a set push; its zero is the instant of touching or
  /// leaving.
  [[nodiscard]] double margin(Set set, const JointVector& q, const JointVector& qd) const noexcept {
    if (const double p = deepest(q); set == 0 && p < 0.0) return -p;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < size_; ++i) {
      const double push = push_margin(stops_[i], q, qd);
      least = std::min(least, (set & (Set{1} << i)) != 0 ? push : -push);
    }
    return least;
  }

  /// How far the posture is past the stop that it is past most, rad.
  [[nodiscard]] double deepest(const JointVector& q) const noexcept {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < size_; ++i) {
      most = std::max(most, depth(stops_[i], q));
    }
    return most;
  }

  /// Torque of the stops of a set, not cut at zero: smooth between events.
  [[nodiscard]] JointVector torque(Set set,
                                   const JointVector& q,
                                   const JointVector& qd) const noexcept {
    JointVector sum = JointVector::Zero();
    for (std::size_t i = 0; i < size_; ++i) {
      if ((set & (Set{1} << i)) == 0) continue;
      const Stop& stop = stops_[i];
      const double push = stop.k * depth(stop, q) + stop.d * rate(stop, qd);
      sum[static_cast<Eigen::Index>(stop.plus)] -= stop.sign * push;
      if (stop.minus != kNone) sum[static_cast<Eigen::Index>(stop.minus)] += push;
    }
    return sum;
  }

  [[nodiscard]] double stored_energy(const JointVector& q) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double p = std::max(depth(stops_[i], q), 0.0);
      sum += stops_[i].k * p * p / 2.0;
    }
    return sum;
  }

  /// Fastest rate at which an inertia moves against the stops of a set, 1/s.
  [[nodiscard]] double fastest(Set set, double inertia) const noexcept {
    double most = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
      if ((set & (Set{1} << i)) == 0) continue;
      most = std::max({most, std::sqrt(stops_[i].k / inertia), stops_[i].d / inertia});
    }
    return most;
  }

 private:
  static constexpr std::size_t kNone = kJoints;

  /// p = sign x_plus − x_minus − limit
  struct Stop {
    std::size_t plus = 0;
    std::size_t minus = kNone;
    double sign = 1.0;
    double limit = 0.0;
    double k = kStiffness;
    double d = kDamping;
  };

  void add(const Stop& stop) noexcept { stops_[size_++] = stop; }

  [[nodiscard]] static double rate(const Stop& stop, const JointVector& x) noexcept {
    const double along = stop.sign * x[static_cast<Eigen::Index>(stop.plus)];
    return stop.minus == kNone ? along : along - x[static_cast<Eigen::Index>(stop.minus)];
  }
  [[nodiscard]] static double depth(const Stop& stop, const JointVector& q) noexcept {
    return rate(stop, q) - stop.limit;
  }
  [[nodiscard]] static double push_margin(const Stop& stop,
                                          const JointVector& q,
                                          const JointVector& qd) noexcept {
    const double p = depth(stop, q);
    return std::min(p, p + stop.d / stop.k * rate(stop, qd));
  }

  std::array<Stop, 14> stops_{};
  std::size_t size_ = 0;
};

}  // namespace teleop
