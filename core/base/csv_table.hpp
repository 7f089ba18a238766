#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace teleop {

/// Columns of numbers out of comma-separated values: a head line of names, then lines of as many
/// numbers. Lines end in LF or CR LF, cells may have spaces around them.
struct CsvTable {
  std::vector<std::string> names{};            ///< as wanted
  std::vector<std::vector<double>> columns{};  ///< one a name, all of one length
  std::vector<std::string> ignored{};          ///< what else the head line names

  static constexpr std::size_t kFirstRow = 2;  ///< line of the first row, as editors count

  [[nodiscard]] std::size_t rows() const noexcept {
    return columns.empty() ? 0 : columns.front().size();
  }
};

/// The names in the head line of CSV text.
[[nodiscard]] std::vector<std::string> csv_names(std::string_view text);

/// Reads the columns `wanted` out of CSV text, in that order, whatever order the head line has;
/// other columns are passed over but for the number of cells. `file` stands for its name in
/// messages.
/// @throws ConfigError naming file and line: no head line, one without names, a name twice, a
///         wanted column missing, no row, a second head line, a line of another number of cells,
///         a wanted cell that is no finite number.
[[nodiscard]] CsvTable parse_csv(std::string_view text,
                                 const std::string& file,
                                 std::span<const std::string> wanted);

/// The same of a file. @throws ConfigError also when it cannot be read.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& file,
                                std::span<const std::string> wanted);

}  // namespace teleop
