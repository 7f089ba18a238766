#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/experiment/sweep_plan.hpp"

namespace teleop {

/// Part i of n of a sweep: the points whose index leaves i − 1 when divided by n.
struct SweepShard {
  std::size_t i = 1;
  std::size_t n = 1;

  [[nodiscard]] bool has(std::size_t index) const noexcept { return index % n == i - 1; }
};

/// The folder of a sweep:
///
///     sweep.toml      the file as it was when the sweep began
///     sweep.json      its fingerprint, number of points, shard
///     results.jsonl   a line a point {index, seed, keys{…}, results{…}}, with the system before
///     the
///                     next point begins, on the disk within a second or with the next point; in
///                     the order of finishing, at the end in that of the index
///     results.csv     the same as a table
///
/// A process killed at any time loses no finished point: opened again, a torn last line is cut off
/// and what is there is not run again. One process at a time has the folder.
///
/// Thread: one at a time.
class SweepStore {
 public:
  /// Begins a folder, or goes on where one was left.
  /// @throws ConfigError: another sweep's folder, another shard's, in use, damaged in the middle.
  SweepStore(std::filesystem::path folder, const SweepPlan& plan, const SweepShard& shard);
  SweepStore(const SweepStore&) = delete;
  SweepStore& operator=(const SweepStore&) = delete;
  SweepStore(SweepStore&&) = delete;
  SweepStore& operator=(SweepStore&&) = delete;
  ~SweepStore();

  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

  /// Lines by index.
  [[nodiscard]] const std::map<std::size_t, std::string>& lines() const noexcept { return lines_; }

  /// Points of the shard that have no result yet, in order.
  [[nodiscard]] std::vector<std::size_t> missing() const;

  /// Keeps a finished point. @throws Error when the disk does not take it.
  void add(std::size_t index, const Results& results);

  /// Takes over lines of another shard of the same sweep.
  /// @throws ConfigError: another sweep's folder, or another result for a point that is here.
  void take(const std::filesystem::path& folder);

  /// Writes both tables again, sorted by index.
  void sort();

 private:
  void begin_or_resume();
  void append(std::size_t index, const std::string& line);
  void write_table_row(const std::string& line);
  [[nodiscard]] std::string table() const;

  std::filesystem::path folder_;
  const SweepPlan& plan_;
  SweepShard shard_;
  int lock_ = -1;
  int results_ = -1;
  Instant synced_{};  ///< when the disk last had everything
  std::vector<std::string> columns_;
  std::map<std::size_t, std::string> lines_;
};

/// A file of lines {index, …}, by index; what follows the last end of line is not a line.
/// @throws ConfigError naming file and line: cannot be read, not such a line, an index twice.
[[nodiscard]] std::map<std::size_t, std::string> read_result_lines(
    const std::filesystem::path& file);

}  // namespace teleop
