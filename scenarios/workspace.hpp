#pragma once

#include <string>

namespace teleop {

struct WorkspaceOptions {
  std::string arm = "phantom-1.5";  ///< arm file or the name of a shipped arm
  std::string out = ".";            ///< folder, made when absent
  double step_mm = 1.0;             ///< of the grid
  std::string json;                 ///< also write the numbers there; empty: nowhere else
};

/// `teleop workspace`: the cross section of an arm's workspace as numbers (workspace.csv a line a
/// grid point, workspace.json) and as a picture after [Cavusoglu 2002, fig. 3] (workspace.png,
/// drawn by gnuplot from workspace.gp).
///
/// @returns 0, or 1 when gnuplot is absent or refuses: then everything but the picture is there.
/// @throws ConfigError: no such arm, a step that is not usable, a folder that cannot be written.
[[nodiscard]] int run_workspace(const WorkspaceOptions& options);

}  // namespace teleop
