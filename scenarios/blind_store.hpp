#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "scenarios/concealed/plan.hpp"

namespace teleop {

/// The folder of a campaign on concealed cases:
///
///     blind.json     cases, seed, shard
///     seals.txt      NAME SHA-256 a line: published before the case is diagnosed
///     cases.jsonl    a line a case with truth and answers, written when it has been opened
///     cases/NAME     recordings and answer, while they are needed
///
/// A process killed at any time loses no finished case: opened again, torn last lines are cut off
/// and what is there is not done again. Every truth in it is held against its seal. One process at
/// a time has the folder.
///
/// Thread: any; calls take turns.
class BlindStore {
 public:
  /// Begins a folder, or goes on where one was left.
  /// @throws ConfigError: another campaign's folder, another shard's, in use, damaged, a truth that
  ///         is not the sealed one.
  BlindStore(std::filesystem::path folder, const concealed::ConcealedPlan& plan);
  BlindStore(const BlindStore&) = delete;
  BlindStore& operator=(const BlindStore&) = delete;
  BlindStore(BlindStore&&) = delete;
  BlindStore& operator=(BlindStore&&) = delete;
  ~BlindStore();

  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
  [[nodiscard]] std::filesystem::path case_folder() const { return folder_ / "cases"; }

  /// Lines by index.
  [[nodiscard]] const std::map<std::size_t, std::string>& lines() const noexcept { return lines_; }
  /// Cases of the shard that have no line yet, in order.
  [[nodiscard]] std::vector<std::size_t> missing() const;

  /// Publishes the seal of a case. @throws Error when another one was published before, or the disk
  /// does not take it.
  void publish(const std::string& name, const std::string& seal);
  /// Keeps an opened case. @throws Error when the truth is not the sealed one, or as publish().
  void add(std::size_t index, const std::string& line);

  /// Takes over the cases of another shard of the same campaign. @throws ConfigError: another one.
  void take(const std::filesystem::path& folder);
  /// Writes lines and seals again, sorted.
  void sort();

 private:
  void begin_or_resume();
  void check_seals() const;

  std::filesystem::path folder_;
  concealed::ConcealedPlan plan_;
  std::mutex turn_;
  int lock_ = -1;
  int results_ = -1;
  int published_ = -1;
  std::map<std::size_t, std::string> lines_;
  std::map<std::string, std::string> seals_;
};

/// The campaign that a folder belongs to, as a whole.
/// @throws ConfigError when it belongs to none.
[[nodiscard]] concealed::ConcealedPlan planned_in(const std::filesystem::path& folder);

/// SHA-256 of the truth in a line of cases.jsonl, as it was sealed: of its canonical text.
[[nodiscard]] std::string seal_of_line(const std::string& line);

/// The canonical text of the truth in a line.
[[nodiscard]] std::string truth_of_line(const std::string& line);

}  // namespace teleop
