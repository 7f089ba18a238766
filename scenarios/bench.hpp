#pragma once

#include <string>
#include <vector>

namespace teleop {

struct BenchOptions {
  double seconds = 20.0;
  std::string json;  ///< file for the rows; empty: none
};

/// One figure beside its peer, measured in the same run. ratio = ours / peer.
struct BenchRow {
  std::string id;
  double ours = 0.0;
  double peer = 0.0;
  std::string peer_name;
  std::string unit;
  double ratio = 0.0;
  bool lower_is_better = true;
};

/// Prints the rows as a table, ratios first, and writes them as JSON when a file was asked for.
/// @throws ConfigError when the file cannot be written.
void report_rows(const std::vector<BenchRow>& rows, const BenchOptions& options);

/// @pre there is a value.
[[nodiscard]] double median(std::vector<double> values);

/// Each measures, reports its rows and returns an exit code.
[[nodiscard]] int bench_diagnose(const BenchOptions& options);
[[nodiscard]] int bench_link(const BenchOptions& options);
[[nodiscard]] int bench_loop(const BenchOptions& options);
[[nodiscard]] int bench_sim(const BenchOptions& options);
[[nodiscard]] int bench_sweep(const BenchOptions& options);

}  // namespace teleop
