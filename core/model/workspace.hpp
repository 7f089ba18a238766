#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {

/// One position of the map.
struct WorkspaceCell {
  Reach reach = Reach::too_far;
  double mu = 0.0;  ///< manipulability, also where only a stop is in the way; 0 where no posture is
};

/// Where the arm can go in its plane x = 0 with q1 = 0, and how evenly it moves there: the cross
/// section of [Cavusoglu 2002, fig. 3]. The workspace is this figure turned about the yaw axis.
/// Positions are tool positions p_BT on a square grid that home (0, 0, 0) belongs to. All numbers
/// are over the cells that the stops allow.
struct WorkspaceMap {
  double step_m = 0.0;
  double y_first_m = 0.0;            ///< of row 0
  double z_first_m = 0.0;            ///< of column 0
  std::size_t rows = 0;              ///< along y
  std::size_t columns = 0;           ///< along z
  std::vector<WorkspaceCell> cells;  ///< row by row

  std::array<std::size_t, 12> counts{};  ///< cells by Reach
  double area_m2 = 0.0;
  Vector3 lowest_m = Vector3::Zero();  ///< corners of the box around the reachable cells
  Vector3 highest_m = Vector3::Zero();
  double mu_min = 0.0;
  double mu_max = 0.0;
  std::array<double, 5> mu_quantiles{};  ///< 5, 25, 50, 75 and 95 %
  double share_half = 0.0;               ///< of the area that has μ ≥ 0.5

  [[nodiscard]] Vector3 position(std::size_t row, std::size_t column) const noexcept {
    return {0.0, y_first_m + static_cast<double>(row) * step_m,
            z_first_m + static_cast<double>(column) * step_m};
  }
  [[nodiscard]] const WorkspaceCell& cell(std::size_t row, std::size_t column) const noexcept {
    return cells[row * columns + column];
  }
  [[nodiscard]] std::size_t count(Reach reach) const noexcept {
    return counts[static_cast<std::size_t>(reach)];
  }
};

/// @pre step_m > 0.
[[nodiscard]] WorkspaceMap map_workspace(const ArmModel& arm, double step_m);

/// The exact edge of the cross section as a closed polygon: the stops bound a polygon of (q2, q3),
/// and its edge, in steps of at most `step_rad`, goes to tool positions. It is the edge of the
/// workspace where the coupled stops keep |q3 − q2| < π/2, as on every PHANToM known here.
[[nodiscard]] std::vector<Vector3> workspace_outline(const ArmModel& arm, double step_rad);

}  // namespace teleop
