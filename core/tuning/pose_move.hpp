#pragma once

#include <cstddef>
#include <vector>

#include "core/model/arm_model.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/tuning/experiment.hpp"

namespace teleop {

/// Carries an arm to a posture and leaves it there, amplifiers on: a minimum-jerk path of the
/// joints [Flash 1985], followed by a soft spring and damper at the tool with the weight carried,
///
///     τ = J_vᵀ (K J_v (q_d − q) − B J_v q̇) + N(q).
///
/// The postures of an arm within its stops are a convex set of joint angles, so no straight path of
/// the joints meets a stop.
struct PoseMove {
  double stiffness_N_per_m = 250.0;
  double damping_Ns_per_m = 2.0;
  double speed_m_per_s = 0.1;  ///< of the tool, mean
  double period_s = 1e-3;
  double tolerance_m = 0.003;  ///< of the tool at the end
  double patience_s = 2.0;     ///< at the end, to get there
};

struct MovedArm {
  Arm* arm = nullptr;
  const ArmModel* model = nullptr;
};

/// Both arms of a pair at once: one that waits must not starve.
/// @throws DeviceError: a fault on the way, or the pose is not reached.
void move_to(const std::vector<MovedArm>& arms,
             Clock& clock,
             const JointVector& q,
             const PoseMove& how);

/// `count` postures spread over the workspace of an arm in its plane x = 0, at least a tenth of a
/// radian from every stop and of manipulability 0.3 or more; home alone where one is asked for.
/// Neither the mass nor the gain of the Jacobian knows the yaw angle, so the plane stands for all.
/// @throws ConfigError when there are not so many.
[[nodiscard]] std::vector<JointVector> spread_poses(const ArmModel& model, std::size_t count);

/// The frame of an arm at a posture.
[[nodiscard]] ToolFrame frame_at(const ArmModel& model, const ArmInfo& info, const JointVector& q);

}  // namespace teleop
