#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace teleop {

/// What `teleop loopback` can be told.
struct LoopbackOptions {
  double seconds = 10.0;
  std::string master = "sim";         ///< device of the master
  std::string slave = "sim";          ///< device of the slave
  std::string hand;                   ///< trace file, "reach", "press" or "none"; empty: as fits
  std::string environment = "free";   ///< free, soft or wall
  std::filesystem::path out;          ///< folder of recordings and report; empty: a new one
  std::filesystem::path json;         ///< summary for scripts; empty: none
  std::vector<std::string> configs;   ///< TOML files for both sides
  std::vector<std::string> settings;  ///< KEY=VALUE for both sides
  std::uint64_t seed = 1;
  bool report = true;
};

/// Starts teleop-master and teleop-slave as processes on 127.0.0.1, shows a live line, and at the
/// end a summary, the report and the recordings. The summary goes to stdout, the rest to stderr.
///
/// @returns 0 done, 1 when a side ended in a fault, else the exit code of the side that failed.
/// @throws Error on bad input, before anything was started or written.
[[nodiscard]] int run_loopback(const LoopbackOptions& options);

}  // namespace teleop
