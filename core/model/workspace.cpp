#include "core/model/workspace.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using Posture2 = Eigen::Vector2d;  ///< (q2, q3)

/// The part of a convex polygon where normal · q ≤ bound [Sutherland, Hodgman 1974].
std::vector<Posture2> clipped(const std::vector<Posture2>& polygon,
                              const Posture2& normal,
                              double bound) {
  std::vector<Posture2> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Posture2& a = polygon[i];
    const Posture2& b = polygon[(i + 1) % polygon.size()];
    const double excess_a = normal.dot(a) - bound;
    const double excess_b = normal.dot(b) - bound;
    if (excess_a <= 0.0) inside.push_back(a);
    if ((excess_a < 0.0) != (excess_b < 0.0) && excess_a != excess_b) {
      inside.emplace_back(a + (b - a) * (excess_a / (excess_a - excess_b)));
    }
  }
  return inside;
}

std::vector<Posture2> allowed_postures(const ArmParameters& arm) {
  const auto [low2, low3] = std::array{arm.lower_limit_rad[1], arm.lower_limit_rad[2]};
  const auto [high2, high3] = std::array{arm.upper_limit_rad[1], arm.upper_limit_rad[2]};
  const std::vector<Posture2> box{{low2, low3}, {high2, low3}, {high2, high3}, {low2, high3}};
  return clipped(clipped(box, {1.0, -1.0}, arm.max_q2_minus_q3_rad), {-1.0, 1.0},
                 arm.max_q3_minus_q2_rad);
}

WorkspaceCell evaluate(const ArmModel& arm, const Vector3& p_BT) {
  // Behind the yaw axis the arm keeps q1 = 0 and leans back over its shoulder.
  const bool behind = p_BT.z() + arm.parameters().l1_m < 0.0;
  const IkResult found =
      inverse_kinematics(arm, p_BT, behind ? IkBranch::flip_up : IkBranch::up, 0.0);
  if (found.reach == Reach::too_far || found.reach == Reach::too_near) return {found.reach, 0.0};
  return {found.reach, manipulability(arm, found.q)};
}

void place_grid(WorkspaceMap& map, const std::vector<Vector3>& outline) {
  Vector3 low = outline.front();
  Vector3 high = outline.front();
  for (const Vector3& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vector3 first = (low / map.step_m).array().floor() - 1.0;
  const Vector3 last = (high / map.step_m).array().ceil() + 1.0;
  map.y_first_m = first.y() * map.step_m;
  map.z_first_m = first.z() * map.step_m;
  map.rows = static_cast<std::size_t>(last.y() - first.y()) + 1;
  map.columns = static_cast<std::size_t>(last.z() - first.z()) + 1;
}

void summarise(WorkspaceMap& map) {
  std::vector<double> mu;
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const WorkspaceCell& cell = map.cell(row, column);
      ++map.counts.at(static_cast<std::size_t>(cell.reach));
      if (cell.reach != Reach::ok) continue;
      const Vector3 p = map.position(row, column);
      if (mu.empty()) map.lowest_m = map.highest_m = p;
      map.lowest_m = map.lowest_m.cwiseMin(p);
      map.highest_m = map.highest_m.cwiseMax(p);
      mu.push_back(cell.mu);
    }
  }
  if (mu.empty()) return;
  std::sort(mu.begin(), mu.end());
  const auto at = [&mu](double share) {
    return mu[static_cast<std::size_t>(std::lround(share * static_cast<double>(mu.size() - 1)))];
  };
  map.mu_min = mu.front();
  map.mu_max = mu.back();
  map.mu_quantiles = {at(0.05), at(0.25), at(0.5), at(0.75), at(0.95)};
  const auto half = std::lower_bound(mu.begin(), mu.end(), 0.5);
  map.share_half = static_cast<double>(mu.end() - half) / static_cast<double>(mu.size());
  map.area_m2 = static_cast<double>(mu.size()) * map.step_m * map.step_m;
}

}  // namespace

WorkspaceMap map_workspace(const ArmModel& arm, double step_m) {
  expects(step_m > 0.0, "the grid of a workspace map has a step");
  constexpr double kOutlineStep = 1e-3;
  WorkspaceMap map;
  map.step_m = step_m;
  const std::vector<Vector3> outline = workspace_outline(arm, kOutlineStep);
  if (outline.empty()) return map;
  place_grid(map, outline);
  map.cells.reserve(map.rows * map.columns);
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      map.cells.push_back(evaluate(arm, map.position(row, column)));
    }
  }
  summarise(map);
  return map;
}

std::vector<Vector3> workspace_outline(const ArmModel& arm, double step_rad) {
  expects(step_rad > 0.0, "the outline of a workspace has a step");
  const std::vector<Posture2> corners = allowed_postures(arm.parameters());
  std::vector<Vector3> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Posture2& a = corners[i];
    const Posture2& b = corners[(i + 1) % corners.size()];
    const auto steps = std::lround(std::ceil((b - a).norm() / step_rad));
    for (long k = 0; k < steps; ++k) {
      const Posture2 q = a + (b - a) * (static_cast<double>(k) / static_cast<double>(steps));
      outline.push_back(tool_position(arm, {0.0, q[0], q[1]}));
    }
  }
  return outline;
}

}  // namespace teleop
