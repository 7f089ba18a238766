#pragma once

#include <string>
#include <vector>

#include "core/experiment/scenario.hpp"

namespace teleop {

struct RunOptions {
  std::string scenario;               ///< file or name in the catalogue; empty: list them
  std::vector<std::string> settings;  ///< KEY=VALUE
  std::string out;                    ///< folder for results and pictures; empty: none
  std::string json;
  bool yes = false;    ///< starts a real arm without asking; needs `force`
  bool force = false;  ///< the arm moves with nobody asked
  bool print = false;  ///< every key of the scenario instead of running it
};

/// Runs one scenario. @returns the exit code: 1 when an arm had a fault.
/// @throws ConfigError before anything moves.
[[nodiscard]] int run_scenario(const RunOptions& options);

/// "KEY=VALUE" of the command line. @throws ConfigError when there is no '='.
[[nodiscard]] std::vector<Override> overrides_of(const std::vector<std::string>& settings);

/// Asks whoever sits at the arm to confirm that it may move.
/// @throws ConfigError when they do not, or when `yes` comes without `force`.
void confirm_start(const ArmInfo& arm, const std::string& what, bool yes, bool force);

}  // namespace teleop
