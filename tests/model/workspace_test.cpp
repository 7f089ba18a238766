#include "core/model/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/model/postures.hpp"

namespace teleop {
namespace {

using testing::phantom;

constexpr double kStep = 0.004;

const WorkspaceMap& coarse_map() {
  static const WorkspaceMap map = map_workspace(phantom(), kStep);
  return map;
}

/// Of a polygon in the y–z plane.
double area_of(const std::vector<Vector3>& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3& a = polygon[i];
    const Vector3& b = polygon[(i + 1) % polygon.size()];
    sum += a.y() * b.z() - a.z() * b.y();
  }
  return std::abs(sum) / 2.0;
}

double distance_to(const std::vector<Vector3>& polygon, const Vector3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3& q : polygon) {
    nearest = std::min(nearest, (p - q).norm());
  }
  return nearest;
}

/// Crossings of the ray along +z.
bool is_inside(const std::vector<Vector3>& polygon, const Vector3& p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3& a = polygon[i];
    const Vector3& b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const double z = a.z() + (b.z() - a.z()) * (p.y() - a.y()) / (b.y() - a.y());
    if (z > p.z()) inside = !inside;
  }
  return inside;
}

TEST(Workspace, HomeIsAReachableGridPointWithTheKnownManipulability) {
  const WorkspaceMap& map = coarse_map();
  const auto row = static_cast<std::size_t>(std::lround(-map.y_first_m / kStep));
  const auto column = static_cast<std::size_t>(std::lround(-map.z_first_m / kStep));
  EXPECT_LT(map.position(row, column).norm(), 1e-12);
  EXPECT_EQ(map.cell(row, column).reach, Reach::ok);
  EXPECT_NEAR(map.cell(row, column).mu, 0.170 / 0.215, 1e-9);
}

TEST(Workspace, ReachableCellsAreThoseInsideTheOutline) {
  const WorkspaceMap& map = coarse_map();
  const std::vector<Vector3> outline = workspace_outline(phantom(), 2e-3);
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const Vector3 p = map.position(row, column);
      if (distance_to(outline, p) < 1e-3) continue;
      ASSERT_EQ(map.cell(row, column).reach == Reach::ok, is_inside(outline, p)) << p.transpose();
    }
  }
}

TEST(Workspace, OutlineStandsAtTheStops) {
  for (const Vector3& p : workspace_outline(phantom(), 0.05)) {
    const bool behind = p.z() < -phantom().parameters().l1_m;
    const JointVector q =
        inverse_kinematics(phantom(), p, behind ? IkBranch::flip_up : IkBranch::up).q;
    const JointVector home{0.0, 0.3, 0.3};
    EXPECT_EQ(check_limits(phantom(), q + 1e-6 * (home - q)), Reach::ok) << q.transpose();
    EXPECT_NE(check_limits(phantom(), q - 1e-6 * (home - q)), Reach::ok) << q.transpose();
  }
}

TEST(Workspace, AreaConvergesToTheAreaInsideTheOutline) {
  const double exact = area_of(workspace_outline(phantom(), 1e-3));
  EXPECT_NEAR(coarse_map().area_m2, exact, 5e-3 * exact);
  EXPECT_NEAR(map_workspace(phantom(), kStep / 4.0).area_m2, exact, 5e-4 * exact);
}

TEST(Workspace, CountsEveryCellOnce) {
  const WorkspaceMap& map = coarse_map();
  EXPECT_EQ(std::accumulate(map.counts.begin(), map.counts.end(), std::size_t{0}),
            map.rows * map.columns);
  EXPECT_EQ(map.cells.size(), map.rows * map.columns);
  EXPECT_EQ(map.count(Reach::joint1_low) + map.count(Reach::joint1_high), 0U);
  EXPECT_EQ(map.count(Reach::not_finite), 0U);
}

TEST(Workspace, NumbersAreThoseOfTheReachableCells) {
  const WorkspaceMap& map = coarse_map();
  std::size_t reachable = 0;
  std::size_t even = 0;
  std::size_t below_median = 0;
  double largest = 0.0;
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const WorkspaceCell& cell = map.cell(row, column);
      if (cell.reach != Reach::ok) continue;
      const Vector3 p = map.position(row, column);
      ++reachable;
      even += cell.mu >= 0.5 ? 1U : 0U;
      below_median += cell.mu < map.mu_quantiles[2] ? 1U : 0U;
      largest = std::max(largest, cell.mu);
      EXPECT_TRUE((p.array() >= map.lowest_m.array()).all());
      EXPECT_TRUE((p.array() <= map.highest_m.array()).all());
      EXPECT_GE(cell.mu, map.mu_min);
    }
  }
  EXPECT_EQ(reachable, map.count(Reach::ok));
  EXPECT_EQ(map.share_half, static_cast<double>(even) / static_cast<double>(reachable));
  EXPECT_NEAR(static_cast<double>(below_median) / static_cast<double>(reachable), 0.5, 1e-3);
  EXPECT_EQ(map.mu_max, largest);
  EXPECT_TRUE(std::is_sorted(map.mu_quantiles.begin(), map.mu_quantiles.end()));
}

TEST(Workspace, OfAnArmWhoseStopsContradictIsEmpty) {
  ArmParameters parameters = phantom().parameters();
  parameters.max_q3_minus_q2_rad = -7.0;
  parameters.max_q2_minus_q3_rad = 8.0;
  const WorkspaceMap map = map_workspace(ArmModel{parameters}, kStep);
  EXPECT_EQ(map.count(Reach::ok), 0U);
  EXPECT_EQ(map.area_m2, 0.0);
}

TEST(Workspace, OnAGridTooCoarseToHitItHasNoNumbers) {
  ArmParameters parameters = phantom().parameters();
  parameters.lower_limit_rad[1] = 0.5;
  parameters.upper_limit_rad[1] = 0.6;
  const WorkspaceMap map = map_workspace(ArmModel{parameters}, 10.0);
  EXPECT_GT(map.cells.size(), 0U);
  EXPECT_EQ(map.count(Reach::ok), 0U);
  EXPECT_EQ(map.mu_max, 0.0);
}

}  // namespace
}  // namespace teleop
