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
  kept.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    kept.push_back(poses[i * poses.size() / count]);
  }
  return kept;
}

ToolFrame frame_at(const ArmModel& model, const ArmInfo& info, const JointVector& q) {
  return {.q0 = q,
          .J = linear_jacobian(model, q),
          .hold_Nm = gravity_torque(model, q),
          .counts_per_rev = info.counts_per_rev};
}

namespace {

/// One arm on its way.
class Mover {
 public:
  Mover(const MovedArm& moved, const JointVector& q, const PoseMove& how)
      : moved_{moved}, start_{moved.arm->read().q}, end_{q}, how_{how} {}

  [[nodiscard]] double distance_m() const {
    return (tool_position(*moved_.model, end_) - tool_position(*moved_.model, start_)).norm();
  }

  /// Towards the point a share of the way along; dt since the last turn.
  void step(double share, double dt) noexcept {
    const ArmState state = moved_.arm->read();
    fault_ = state.q.allFinite() ? state.fault : Fault::state_not_finite;
    if (fault_ != Fault::none) return;
    const JointVector qd = velocity_.step({.q = state.q, .period_ticks = {}, .dt = dt});
    const Matrix3 J = linear_jacobian(*moved_.model, state.q);
    const Vector3 error = J * (start_ + share * (end_ - start_) - state.q);
    const Vector3 force = how_.stiffness_N_per_m * error - how_.damping_Ns_per_m * (J * qd);
    moved_.arm->write(J.transpose() * force + gravity_torque(*moved_.model, state.q));
    off_m_ = (J * (end_ - state.q)).norm();
    speed_ = (J * qd).norm();
  }

  [[nodiscard]] Fault fault() const noexcept { return fault_; }
  [[nodiscard]] double off_m() const noexcept { return off_m_; }
  [[nodiscard]] bool is_there() const noexcept {
    constexpr double kStill_m_per_s = 0.005;
    return fault_ == Fault::none && off_m_ < how_.tolerance_m && speed_ < kStill_m_per_s;
  }

 private:
  MovedArm moved_;
  JointVector start_;
  JointVector end_;
  PoseMove how_;
  DifferenceVelocity velocity_{{}};
  Fault fault_ = Fault::none;
  double off_m_ = 0.0;
  double speed_ = 0.0;
};

}  // namespace

void move_to(const std::vector<MovedArm>& arms,
             Clock& clock,
             const JointVector& q,
             const PoseMove& how) {
  std::vector<Mover> movers;
  double duration = 0.3;
  for (const MovedArm& moved : arms) {
    movers.emplace_back(moved, q, how);
    duration = std::max(duration, movers.back().distance_m() / how.speed_m_per_s);
    moved.arm->amplifiers(true);
  }
  const Duration period{static_cast<std::int64_t>(std::llround(how.period_s * 1e9))};
  const Instant begin = clock.now();
  run_periodically(clock, period, [&](const Tick& tick) noexcept {
    const double time_s = seconds(tick.now - begin);
    const double s = std::min(time_s / duration, 1.0);
    const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    bool there = s == 1.0;
    bool failed = false;
    for (Mover& mover : movers) {
      mover.step(share, seconds(tick.elapsed));
      there = there && mover.is_there();
      failed = failed || mover.fault() != Fault::none;
    }
    const bool too_late = time_s > duration + how.patience_s;
    return there || failed || too_late ? Next::stop : Next::again;
  });
  for (std::size_t i = 0; i < arms.size(); ++i) {
    if (movers[i].is_there()) continue;
    for (const MovedArm& moved : arms) {
      moved.arm->amplifiers(false);
    }
    const std::string name = arms[i].arm->info().name;
    if (movers[i].fault() != Fault::none) {
      throw DeviceError{fmt::format("device '{}': fault {} on the way to a pose", name,
                                    name_of(movers[i].fault()))};
    }
    throw DeviceError{fmt::format(
        "device '{}': stays {:.1f} mm from the pose it was sent to; is its way free and its model "
        "the right one?",
        name, 1e3 * movers[i].off_m())};
  }
}

}  // namespace teleop
