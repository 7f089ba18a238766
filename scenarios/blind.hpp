#pragma once

#include <string>
#include <vector>

#include "scenarios/concealed/plan.hpp"

namespace teleop {

struct BlindOptions {
  concealed::ConcealedPlan plan{};
  std::string shard = "1/1";
  std::string out{};                  ///< folder; empty: blind-SEED or nulls-SEED
  std::string json{};                 ///< the figures for scripts
  unsigned threads = 0;               ///< cases at a time, each on one thread; 0: one a core
  bool keep = false;                  ///< recordings and answers stay
  bool markdown = false;              ///< tables as a document takes them
  std::string diagnose{};             ///< program that diagnoses; empty: this one
  std::vector<std::string> shards{};  ///< of a merge: the folders
};

/// Diagnoses concealed cases, or what is left of them, and scores the answers.
/// @returns 0 when every case of the shard is done.
/// @throws ConfigError before anything is done.
[[nodiscard]] int run_blind(const BlindOptions& options);

/// Puts the shards of one campaign together. @throws ConfigError when a case is missing.
[[nodiscard]] int merge_blind(const BlindOptions& options);

}  // namespace teleop
