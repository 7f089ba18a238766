#pragma once

#include <string>

#include "core/model/workspace.hpp"

namespace teleop {

/// The gnuplot script that draws workspace.png from workspace.csv, both in the working directory:
/// manipulability in colour and as labelled lines inside the exact outline of the workspace, the
/// arm at home, axes in mm.
[[nodiscard]] std::string workspace_picture(const ArmModel& arm, const WorkspaceMap& map);

}  // namespace teleop
