#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/diagnosis/recording.hpp"
#include "core/recording/log.hpp"

namespace teleop {

/// The cases in our own recordings: one a machine, which is one role and arm, in the order in which
/// the logs name them; each log gives its machine's case at least one run. The arm gives the
/// resolution of the readings, the metadata what else a log says of itself (Recording::about).
///
///     tau       torques commanded, of the turn whose reading is q
///     contact   −J_vᵀ f where the arm measured the force f on its tool in every turn
///     measured  N k_t i where the arm measured its motor currents i in every turn
///
/// Only turns with the amplifiers on count. Where turns came late or not at all, by more than half
/// a period off the grid of times, or the device dropped its torque, a run ends and another begins:
/// nothing is interpolated. What is shorter than kShortestRun_s is left out. The notes of the first
/// run of a log tell of it.
/// @throws RecordingError: a file that is no log; ConfigError: a log that does not name arm and
///         rate, counts that are not of that arm, two rates of one machine, no usable stretch.
[[nodiscard]] std::vector<DiagnosisCase> read_log_cases(
    std::span<const std::filesystem::path> files);

inline constexpr double kShortestRun_s = 0.5;

/// The runs of one log.
[[nodiscard]] std::vector<Recording> runs_of(const Log& log);

}  // namespace teleop
