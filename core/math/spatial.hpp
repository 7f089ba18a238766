#pragma once

#include <Eigen/Geometry>

namespace teleop {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// Pose X_AB of frame B in frame A.
struct Pose {
  Matrix3 R = Matrix3::Identity();  ///< R_AB
  Vector3 p = Vector3::Zero();      ///< p_AB, m
};

/// Velocity of one frame seen from another: V_WT is the velocity of T in W, its two parts
/// expressed in W. SI: rad/s, m/s.
struct Twist {
  Vector3 angular = Vector3::Zero();
  Vector3 linear = Vector3::Zero();
};

/// Moment and force acting at the origin of a frame: F_T acts at T. SI: N m, N.
struct Wrench {
  Vector3 moment = Vector3::Zero();
  Vector3 force = Vector3::Zero();
};

/// Mechanical power that a wrench delivers to the frame it acts on, W.
[[nodiscard]] inline double power(const Wrench& F_T, const Twist& V_WT) noexcept {
  return F_T.moment.dot(V_WT.angular) + F_T.force.dot(V_WT.linear);
}

}  // namespace teleop
