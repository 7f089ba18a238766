#pragma once

#include <Eigen/Core>

#include "core/diagnosis/noise_model.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// How well the tether knows angles, speeds and disturbances: the covariance of the Kalman filter
/// whose gains Tether has, whole, for smoothing and for looking ahead.
class TetherCovariance {
 public:
  using Matrix = Eigen::Matrix<double, 9, 9>;  ///< of (q, v, d)

  TetherCovariance(const NoiseModel& noise, double period_s);

  /// Of the present instant.
  [[nodiscard]] const Matrix& matrix() const noexcept { return P_; }

  /// Covariance of an innovation.
  [[nodiscard]] JointMatrix of_innovation() const;

  /// A reading is taken in.
  void update();

  /// A sample passes. @param mobility M⁻¹
  /// @param stiffness of weight and springs, N m/rad; the tether does not know of it
  void pass(const JointMatrix& mobility, const JointMatrix& stiffness = JointMatrix::Zero());

  /// The disturbance is taken for zero from now on, whatever was known of it.
  void forget_disturbance();

  /// What a sample makes of (q, v, d).
  [[nodiscard]] Matrix transition(const JointMatrix& mobility,
                                  const JointMatrix& stiffness = JointMatrix::Zero()) const;

 private:
  NoiseModel noise_;
  double period_s_;
  JointVector memory_;  ///< φ
  Matrix P_ = Matrix::Zero();
};

}  // namespace teleop
