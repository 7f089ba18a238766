#pragma once

#include <Eigen/Core>

#include "core/model/arm_model.hpp"

namespace teleop {

/// How far the rigid body itself may be off: every mass and inertia of the arm by `tolerance`,
/// independently. What recordings can tell are the lumped constants of ArmModel, so the prior is
/// the normal one that this means for them: lumped = nominal + spread z, z ~ N(0, 1).
class BasePrior {
 public:
  static constexpr Eigen::Index kSize = 8;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  /// @param tolerance standard deviation, as a share
  BasePrior(const ArmModel& arm, double tolerance);

  [[nodiscard]] ArmModel arm(const Vector& z) const;

 private:
  ArmModel nominal_;
  Eigen::Matrix<double, kSize, kSize> spread_;
};

}  // namespace teleop
