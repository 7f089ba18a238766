#pragma once

#include <cstdint>
#include <string_view>

#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

using Jacobian = Eigen::Matrix<double, 6, 3>;  ///< rows v_x v_y v_z ω_x ω_y ω_z

/// Pose of the tool T in the arm's base frame B [Cavusoglu 2002, eq. 1]:
///     p = (s1 ρ, l2 − l2 c3 + l1 s2, −l1 + c1 ρ),  ρ = l1 c2 + l2 s3,  R = Ry(q1) Rx(−q3).
/// Loop: allocation-free, noexcept, like everything in this file.
[[nodiscard]] Pose forward_kinematics(const ArmModel& arm, const JointVector& q) noexcept;
[[nodiscard]] Vector3 tool_position(const ArmModel& arm, const JointVector& q) noexcept;

/// V_T = J_b q̇, expressed in the tool frame T.
[[nodiscard]] Jacobian body_jacobian(const ArmModel& arm, const JointVector& q) noexcept;
/// Velocity of the tool's origin and angular velocity, both expressed in B; τ = J_hᵀ F.
[[nodiscard]] Jacobian hybrid_jacobian(const ArmModel& arm, const JointVector& q) noexcept;
/// Upper half of the hybrid Jacobian: v_BT = J_v q̇, τ = J_vᵀ f.
[[nodiscard]] Matrix3 linear_jacobian(const ArmModel& arm, const JointVector& q) noexcept;
/// d/dt J_v along q̇: a_BT = J_v q̈ + J̇_v q̇.
[[nodiscard]] Matrix3 linear_jacobian_rate(const ArmModel& arm,
                                           const JointVector& q,
                                           const JointVector& qd) noexcept;

/// μ = σ_min / σ_max of J_v [Cavusoglu 2002, fig. 3]: 1 where all directions are equal, 0 at a
/// singular posture (tool on the yaw axis, arm stretched or folded).
[[nodiscard]] double manipulability(const ArmModel& arm, const JointVector& q) noexcept;

/// Why a position or posture cannot be had. Numbers are stable.
enum class Reach : std::uint8_t {
  ok = 0,
  too_far = 1,   ///< beyond l1 + l2 from the shoulder
  too_near = 2,  ///< nearer than |l1 − l2| to the shoulder
  joint1_low = 3,
  joint1_high = 4,
  joint2_low = 5,
  joint2_high = 6,
  joint3_low = 7,
  joint3_high = 8,
  q2_minus_q3 = 9,  ///< coupled stop of the parallelogram
  q3_minus_q2 = 10,
  not_finite = 11,
};
[[nodiscard]] std::string_view text_of(Reach reach) noexcept;

enum class IkBranch : std::uint8_t { up = 0, down = 1, flip_up = 2, flip_down = 3 };

struct IkResult {
  /// ok and joint limits: the exact solution. too_far, too_near: the arm stretched or folded
  /// towards the position, the nearest it can come. not_finite: zero. Never NaN.
  JointVector q = JointVector::Zero();
  Reach reach = Reach::ok;
};

/// Joint angles of a tool position. IkBranch::up inverts forward_kinematics where |q3 − q2| < π/2
/// and ρ > 0; q1 and q2 lie in [−π, π] and q3 within π of q2, as the coupled stops want it. Closer
/// to the yaw axis than 1e-9 (l1 + l2) q1 is not determined: `previous_q1` is kept, so a hand that
/// rests on the axis does not spin the base. A shoulder distance that misses its bound by less than
/// that is taken for the bound.
[[nodiscard]] IkResult inverse_kinematics(const ArmModel& arm,
                                          const Vector3& p_BT,
                                          IkBranch branch = IkBranch::up,
                                          double previous_q1 = 0.0) noexcept;

/// The first joint or coupled limit that a posture breaks; a posture at its limit breaks none.
[[nodiscard]] Reach check_limits(const ArmModel& arm, const JointVector& q) noexcept;

}  // namespace teleop
