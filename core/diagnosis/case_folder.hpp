#pragma once

#include <filesystem>

#include "core/diagnosis/recording.hpp"

namespace teleop {

/// Reads a case: a folder with a case.toml, or such a file under any name, and the CSV recordings
/// that it lists. They lie beside it, or in `data` where that is given.
///
/// Of a shipped arm (plant = "phantom-1.5") a run has the columns t_s, tau1_Nm … tau3_Nm, q1_rad …
/// q3_rad. Of a bench (plant = "rigid-axes") the case names the column of each axis's position, and
/// those of the forces on it with their gains: what comes out is N m or N. In either the columns
/// are found by their names; further ones are passed over, and said so. A run may be a window of
/// its file, start_s ≤ t_s < stop_s; windows of one file get names that tell them apart.
///
/// What is in the columns is judged by audit(), this only reads it.
/// @throws ConfigError, one line that names file, row and what to do: a file that is missing, an
///         unknown or missing key, a column that is missing, a cell that is no finite number, rows
///         of unequal length, a second head line, a run or a window without rows.
[[nodiscard]] DiagnosisCase read_case(const std::filesystem::path& path,
                                      const std::filesystem::path& data = {});

/// The case that a single recording belongs to, with that one as its only run, listed there or not.
/// @throws ConfigError as read_case() does.
[[nodiscard]] DiagnosisCase read_case_of_run(const std::filesystem::path& recording);

}  // namespace teleop
