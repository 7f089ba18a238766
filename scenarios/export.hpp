#pragma once

#include <filesystem>

namespace teleop {

/// `teleop export LOG --csv FILE`: every tick as a line of numbers. Says on stderr, and in `json`
/// if that is named, what was done and what was damaged.
/// @returns the exit code of the program.
/// @throws RecordingError: no such log, nothing readable in it, `csv` exists or cannot be written.
int run_export(const std::filesystem::path& log,
               const std::filesystem::path& csv,
               const std::filesystem::path& json);

/// `teleop recover LOG [--out FILE]`: a cut-off or damaged log as a new and closed one. An empty
/// `out` stands for LOG's name with `.recovered` before the extension. Says on stderr, and in
/// `json` if that is named, what was kept and lost.
/// @returns the exit code of the program.
/// @throws RecordingError: no such log, nothing readable in it, `out` exists or cannot be written.
int run_recover(const std::filesystem::path& log,
                std::filesystem::path out,
                const std::filesystem::path& json);

}  // namespace teleop
