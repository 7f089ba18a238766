#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// The joint stops and the coupled stops of the parallelogram as springs and dampers that push and
/// never pull: with p the angle past a stop, the torque back is max(0, k p + d ṗ).
///
/// Assumed: k so stiff that the motors' full torque presses a stop in by less than 0.4 mrad; d
/// about half of critical with a joint's inertia, so that the arm rebounds little. Loop:
/// allocation-free, noexcept.
class JointStops {
 public:
  static constexpr std::size_t kNumber = 8;
  static constexpr double kStiffness = 5000.0;  ///< k, N m/rad
  static constexpr double kDamping = 2.5;       ///< d, N m s/rad

  /// Which of them push, a bit each.
  using Set = std::uint32_t;

  explicit JointStops(const ArmModel& arm) {
    const ArmParameters& limits = arm.parameters();
    for (std::size_t i = 0; i < kJoints; ++i) {
      limits_[2 * i] = -limits.lower_limit_rad.at(i);
      limits_[2 * i + 1] = limits.upper_limit_rad.at(i);
    }
    limits_[6] = limits.max_q2_minus_q3_rad;
    limits_[7] = limits.max_q3_minus_q2_rad;
  }

  /// Past the stop and how fast; the same combination of angles and of speeds.
  [[nodiscard]] double depth(std::size_t stop, const JointVector& q) const noexcept {
    return along(stop, q) - limits_[stop];
  }
  [[nodiscard]] double depth_rate(std::size_t stop, const JointVector& qd) const noexcept {
    return along(stop, qd);
  }

  /// Positive where the stop pushes; its zero is the instant of touching or leaving. In rad.
  [[nodiscard]] double push_margin(std::size_t stop,
                                   const JointVector& q,
                                   const JointVector& qd) const noexcept {
    const double p = depth(stop, q);
    return std::min(p, p + kDamping / kStiffness * depth_rate(stop, qd));
  }

  [[nodiscard]] Set pushing(const JointVector& q, const JointVector& qd) const noexcept {
    Set set = 0;
    for (std::size_t stop = 0; stop < kNumber; ++stop) {
      if (push_margin(stop, q, qd) > 0.0) set |= Set{1} << stop;
    }
    return set;
  }

  /// Positive while exactly the stops of a set push.
  [[nodiscard]] double margin(Set set, const JointVector& q, const JointVector& qd) const noexcept {
    double deepest = depth(0, q);
    for (std::size_t stop = 1; stop < kNumber; ++stop) {
      deepest = std::max(deepest, depth(stop, q));
    }
    if (set == 0 && deepest < 0.0) return -deepest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t stop = 0; stop < kNumber; ++stop) {
      const double push = push_margin(stop, q, qd);
      least = std::min(least, (set & (Set{1} << stop)) != 0 ? push : -push);
    }
    return least;
  }

  /// Torque of the stops of a set, not cut at zero: smooth between events.
  [[nodiscard]] JointVector torque(Set set,
                                   const JointVector& q,
                                   const JointVector& qd) const noexcept {
    JointVector sum = JointVector::Zero();
    for (std::size_t stop = 0; stop < kNumber; ++stop) {
      if ((set & (Set{1} << stop)) == 0) continue;
      const double push = kStiffness * depth(stop, q) + kDamping * depth_rate(stop, qd);
      if (stop < 6) {
        sum[static_cast<Eigen::Index>(stop / 2)] += stop % 2 == 0 ? push : -push;
      } else {
        sum[1] += stop == 6 ? -push : push;
        sum[2] += stop == 6 ? push : -push;
      }
    }
    return sum;
  }

  [[nodiscard]] double stored_energy(const JointVector& q) const noexcept {
    double sum = 0.0;
    for (std::size_t stop = 0; stop < kNumber; ++stop) {
      const double p = std::max(depth(stop, q), 0.0);
      sum += kStiffness * p * p / 2.0;
    }
    return sum;
  }

 private:
  [[nodiscard]] static double along(std::size_t stop, const JointVector& x) noexcept {
    switch (stop) {
      case 0:
        return -x[0];
      case 1:
        return x[0];
      case 2:
        return -x[1];
      case 3:
        return x[1];
      case 4:
        return -x[2];
      case 5:
        return x[2];
      case 6:
        return x[1] - x[2];
      default:
        return x[2] - x[1];
    }
  }

  std::array<double, kNumber> limits_{};
};

}  // namespace teleop
