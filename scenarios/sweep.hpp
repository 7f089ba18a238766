#pragma once

#include <string>
#include <vector>

namespace teleop {

struct SweepOptions {
  std::string scenario;  ///< file or name in the catalogue
  std::string out;       ///< folder; empty: NAME-sweep
  std::string json;      ///< summary for scripts
  std::string shard = "1/1";
  unsigned jobs = 0;  ///< 0: one a core
  bool yes = false;   ///< starts a real arm without asking; needs `force`
  bool force = false;
  std::vector<std::string> shards;  ///< of a merge: the folders
};

/// Runs a sweep, or what is left of it. @returns 0 when every point has a result.
/// @throws ConfigError before anything is run.
[[nodiscard]] int run_sweep_verb(const SweepOptions& options);

/// Puts the shards of one sweep together. @throws ConfigError when a point is missing.
[[nodiscard]] int merge_sweeps(const SweepOptions& options);

}  // namespace teleop
