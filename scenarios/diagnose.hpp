#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace teleop {

struct DiagnoseOptions {
  std::vector<std::filesystem::path> cases{};  ///< case folders or files, or logs of one machine
  std::filesystem::path data{};                ///< where the recordings of a case file lie
  std::filesystem::path json{};                ///< the answer of a single case
  std::filesystem::path json_dir{};            ///< an answer a case
  std::filesystem::path report{};              ///< page about a single case
  std::filesystem::path report_dir{};          ///< a page a case, and one that leads to them
  std::filesystem::path corrected{};           ///< plant file with what was found
  std::filesystem::path next{};                ///< scenario of the next experiment
  int threads = 0;                             ///< 0: as many as there are cores
};

/// Finds the physics that the nominal model of each case leaves out. Ctrl-C ends the search of the
/// case at hand: what is known by then is written, and the exit code is 1.
/// @throws ConfigError before anything is computed: recordings that cannot be used, files that
///         cannot be written.
int run_diagnose(const DiagnoseOptions& options);

}  // namespace teleop
