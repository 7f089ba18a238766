#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace teleop {

/// Actuated joints of a PHANToM: yaw, upper arm, forearm (absolute angle, parallelogram).
inline constexpr std::size_t kJoints = 3;

/// One number a joint: angles in rad, speeds in rad/s, torques in N m.
using JointVector = Eigen::Vector3d;
using JointMatrix = Eigen::Matrix3d;

}  // namespace teleop
