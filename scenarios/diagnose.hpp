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
  std::filesystem::path corrected{};           ///< plant file with what was found
  int threads = 0;                             ///< 0: as many as there are cores
};

/// Finds the physics that the nominal model of each case leaves out.
/// @throws ConfigError before anything is computed: recordings that cannot be used.
int run_diagnose(const DiagnoseOptions& options);

}  // namespace teleop
