#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace teleop {

struct PredictOptions {
  std::string model = "phantom-1.5-bare";     ///< plant file, or name of a shipped plant
  std::vector<std::filesystem::path> runs{};  ///< recordings, each with a case.toml beside it
  std::filesystem::path json{};
};

/// How well a model predicts recordings, one sample ahead and left to itself. Every model is held
/// to the readings by the same gains, so that figures of two models compare.
int run_predict(const PredictOptions& options);

}  // namespace teleop
