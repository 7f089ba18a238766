#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// From commanded to delivered torques, in continuous time and in closed form. Commands are held;
/// between the instants at which one of them arrives, each axis delivers
///
///     a(t) = c0 + c1 exp(−t / thermal time constant) + c2 exp(−t / lag),
///
/// which solves saturation, dead zone, thermal loss, gain and lag of ActuationTerms exactly, for
/// delays that need not be whole samples. Before the first command everything is as if it had been
/// given for ever, but cold.
/// Loop: everything but the constructor is allocation-free, noexcept.
class ActuationChain {
 public:
  explicit ActuationChain(const std::array<ActuationTerms, kJoints>& terms);

  /// Commanded torques from now on, N m.
  void command(const JointVector& u) noexcept;

  /// Delivered torques `dt` seconds from now, bias and coupling included, ripple not.
  /// @pre 0 ≤ dt ≤ next_change()
  [[nodiscard]] JointVector torque(double dt) const noexcept {
    if (plain_) return u_;
    JointVector a;
    for (std::size_t i = 0; i < kJoints; ++i) {
      a[static_cast<Eigen::Index>(i)] = axes_[i].at(dt) + axes_[i].offset;
    }
    return a;
  }

  /// Seconds until the torque changes its form; infinity when nothing is on its way.
  [[nodiscard]] double next_change() const noexcept;

  void advance(double dt) noexcept;

  /// Torques stay as they are until the next change.
  [[nodiscard]] bool constant() const noexcept;

 private:
  struct Axis {
    double arrived = 0.0;     ///< command behind delay, saturation and dead zone
    double heat = 0.0;        ///< H
    double offset = 0.0;      ///< bias and coupling
    std::size_t waiting = 0;  ///< number of the next command to arrive
    double c0 = 0.0, c1 = 0.0, rate1 = 0.0, c2 = 0.0, rate2 = 0.0;
    double form_ends = std::numeric_limits<double>::infinity();  ///< of the thermal loss

    [[nodiscard]] double at(double dt) const noexcept;
  };
  struct Command {
    double at = 0.0;
    JointVector u = JointVector::Zero();
  };

  void arrive(std::size_t axis, double u) noexcept;
  void shape(std::size_t axis, double a) noexcept;
  [[nodiscard]] double until_arrival(std::size_t axis) const noexcept;

  std::array<ActuationTerms, kJoints> terms_;
  bool plain_ = true;  ///< nothing stands between command and torque
  bool delays_ = false;
  bool started_ = false;
  double now_ = 0.0;
  JointVector u_ = JointVector::Zero();
  std::array<Axis, kJoints> axes_{};
  std::vector<Command> history_;  ///< a ring
  std::size_t commands_ = 0;
};

}  // namespace teleop
