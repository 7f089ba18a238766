#include "core/tuning/pose_move.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/estimation/difference_velocity.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "core/model/workspace.hpp"
#include "core/realtime/loop.hpp"

namespace teleop {
namespace {

constexpr double kFromStops_rad = 0.1;
constexpr double kManipulability = 0.3;

bool is_comfortable(const ArmModel& model, const JointVector& q) {
  for (int corner = 0; corner < 8; ++corner) {
    const JointVector sign{(corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                           (corner & 4) != 0 ? 1.0 : -1.0};
    if (check_limits(model, q + kFromStops_rad * sign) != Reach::ok) return false;
  }
  return manipulability(model, q) >= kManipulability;
}

std::vector<JointVector> comfortable_poses(const ArmModel& model, double step_m) {
  const WorkspaceMap map = map_workspace(model, step_m);
  std::vector<JointVector> poses;
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const IkResult posture = inverse_kinematics(model, map.position(row, column));
      if (posture.reach == Reach::ok && is_comfortable(model, posture.q)) {
        poses.push_back(posture.q);
      }
    }
  }
  return poses;
}

}  // namespace

std::vector<JointVector> spread_poses(const ArmModel& model, std::size_t count) {
  if (count == 1) return {JointVector::Zero()};
  double step_m = 0.2;
  std::vector<JointVector> poses;
  while (poses.size() < count) {
    step_m *= 0.93;
    if (step_m < 2e-3) throw ConfigError{"tuning: the arm has not so many poses"};
    poses = comfortable_poses(model, step_m);
  }
  // The grid has a few more: leave out evenly.
  std::vector<JointVector> kept;
  for (std::size_t i = 0; i < count; ++i)
    kept.push_back(poses[i * poses.size() / count]);
  return kept;
}

ToolFrame frame_at(const ArmModel& model, const ArmInfo& info, const JointVector& q) {
  return {.q0 = q,
          .J = linear_jacobian(model, q),
          .hold_Nm = gravity_torque(model, q),
          .counts_per_rev = info.counts_per_rev};
}

void move_to(
    Arm& arm, const ArmModel& model, Clock& clock, const JointVector& q, const PoseMove& how) {
  const JointVector start = arm.read().q;
  const double distance = (tool_position(model, q) - tool_position(model, start)).norm();
  const double duration = std::max(0.3, distance / how.speed_m_per_s);
  DifferenceVelocity velocity{{}};
  Instant last{};
  bool is_first = true;
  double time_s = 0.0;
  double off_m = 0.0;
  Fault fault = Fault::none;
  arm.amplifiers(true);
  const Duration period{static_cast<std::int64_t>(std::llround(how.period_s * 1e9))};
  run_periodically(clock, period, [&](const Tick&) noexcept {
    const ArmState state = arm.read();
    fault = state.q.allFinite() ? state.fault : Fault::state_not_finite;
    if (fault != Fault::none) return Next::stop;
    const double dt = is_first ? how.period_s : seconds(state.stamp - last);
    is_first = false;
    last = state.stamp;
    time_s += dt;
    const double s = std::min(time_s / duration, 1.0);
    const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    const JointVector qd = velocity.step({.q = state.q, .period_ticks = {}, .dt = dt});
    const Matrix3 J = linear_jacobian(model, state.q);
    const Vector3 error = J * (start + share * (q - start) - state.q);
    const Vector3 force = how.stiffness_N_per_m * error - how.damping_Ns_per_m * (J * qd);
    arm.write(J.transpose() * force + gravity_torque(model, state.q));
    off_m = (J * (q - state.q)).norm();
    const bool there = s == 1.0 && off_m < how.tolerance_m && (J * qd).norm() < 0.005;
    return there || time_s > duration + how.patience_s ? Next::stop : Next::again;
  });
  if (fault == Fault::none && off_m < how.tolerance_m) return;
  arm.amplifiers(false);
  const std::string name = arm.info().name;
  if (fault != Fault::none) {
    throw DeviceError{
        fmt::format("device '{}': fault {} on the way to a pose", name, name_of(fault))};
  }
  throw DeviceError{
      fmt::format("device '{}': stays {:.1f} mm from the pose it was sent to; is its "
                  "way free and its model the right one?",
                  name, 1e3 * off_m)};
}

}  // namespace teleop
