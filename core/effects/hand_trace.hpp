#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/effects/hand_motion.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// A recorded motion of a hand, as it stands in its file.
struct HandTrace {
  enum class Column { yaw_angle, position };
  Column column = Column::yaw_angle;
  std::vector<double> t_s{};      ///< strictly increasing
  std::vector<Vector3> values{};  ///< (q1, 0, 0) in rad, or tool positions relative to home in m
};

/// Reads CSV with the columns t_s,q_rad (θ1, the other joints at home) or t_s,x_m,y_m,z_m; other
/// columns are ignored, any rate will do.
/// @throws ConfigError naming file and row: no such file, a column missing, a cell that is not a
///         finite number, time that does not increase, fewer than two rows.
[[nodiscard]] HandTrace read_hand_trace(const std::filesystem::path& file);

/// The same from text; `file` stands for its name in messages.
[[nodiscard]] HandTrace parse_hand_trace(std::string_view csv, const std::string& file);

/// The trace as one turn of a loop: Catmull–Rom through its points, sampled at the hand's knots.
/// Its end is bent to meet its beginning, over as long as a hand needs for that, and its length
/// rounded to whole knots.
[[nodiscard]] std::vector<HandKnot> closed_loop_of(const HandTrace& trace, const ArmModel& arm);

}  // namespace teleop
