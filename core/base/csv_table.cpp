#include "core/base/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr std::size_t kNotWanted = static_cast<std::size_t>(-1);

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) {
    cell.remove_prefix(1);
  }
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) {
    cell.remove_suffix(1);
  }
  return cell;
}

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view take_cell(std::string_view& line) {
  const std::size_t end = std::min(line.find(','), line.size());
  const std::string_view cell = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return trimmed(cell);
}

std::size_t cells_of(std::string_view line) {
  return 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
}

std::optional<double> finite_number(std::string_view cell) {
  double value = 0.0;
  const char* const begin = std::to_address(cell.begin());
  const char* const end = begin + cell.size();
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Long cells would make the one line of a message unreadable.
std::string_view shortened(std::string_view cell) { return cell.substr(0, 40); }

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& file, std::span<const std::string> wanted)
      : rest_{without_mark(text)}, file_{file} {
    table_.names.assign(wanted.begin(), wanted.end());
    table_.columns.resize(wanted.size());
  }

  CsvTable read() {
    read_head();
    const auto lines = static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n')) + 1;
    for (auto& column : table_.columns) {
      column.reserve(lines);
    }
    for (; !rest_.empty(); ++line_) {
      read_row(take_line(rest_));
    }
    if (table_.rows() == 0) {
      throw ConfigError{
          fmt::format("{}:1: is empty: there is no row of numbers below the head line; "
                      "leave the file out or record it again",
                      file_)};
    }
    return std::move(table_);
  }

 private:
  void read_head() {
    head_ = take_line(rest_);
    if (trimmed(head_).empty()) {
      throw ConfigError{
          fmt::format("{}:1: there is no head line; the first line must name the "
                      "columns: {}",
                      file_, fmt::join(table_.names, ","))};
    }
    std::vector<std::string> found;
    for (const std::string& name : csv_names(head_)) {
      add_name(name, found);
    }
    for (std::size_t i = 0; i < table_.names.size(); ++i) {
      if (std::find(targets_.begin(), targets_.end(), i) != targets_.end()) continue;
      throw ConfigError{fmt::format("{}:1: column {} is missing; the head line has: {}", file_,
                                    table_.names[i], shortened_head())};
    }
  }

  void add_name(std::string_view name, std::vector<std::string>& found) {
    if (finite_number(name)) {
      throw ConfigError{
          fmt::format("{}:1: the head line is missing: its first line has the number "
                      "'{}' where it must name the columns: {}",
                      file_, name, fmt::join(table_.names, ","))};
    }
    if (std::find(found.begin(), found.end(), name) != found.end()) {
      throw ConfigError{fmt::format("{}:1: column {} is there twice; rename or remove one", file_,
                                    shortened(name))};
    }
    found.emplace_back(name);
    const auto place = std::find(table_.names.begin(), table_.names.end(), name);
    const bool wanted = place != table_.names.end();
    targets_.push_back(wanted ? static_cast<std::size_t>(place - table_.names.begin())
                              : kNotWanted);
    if (!wanted) table_.ignored.emplace_back(name);
  }

  [[nodiscard]] std::string shortened_head() const {
    constexpr std::size_t kLongest = 120;
    return head_.size() <= kLongest ? std::string{head_}
                                    : fmt::format("{} …", head_.substr(0, kLongest));
  }

  void read_row(std::string_view line) {
    if (trimmed(line).empty() && trimmed(rest_).empty()) return;  // a last blank line
    const std::string_view whole = line;
    for (const std::size_t target : targets_) {
      const std::string_view cell = take_cell(line);
      if (target == kNotWanted) continue;
      const std::optional<double> number = finite_number(cell);
      if (!number) refuse(whole, cell, target);
      table_.columns[target].push_back(*number);
    }
    if (cells_of(whole) != targets_.size()) refuse_width(whole);
  }

  [[noreturn]] void refuse(std::string_view line, std::string_view cell, std::size_t target) const {
    if (line == head_) {
      throw ConfigError{
          fmt::format("{}:{}: a second head line; one run a file: split it there", file_, line_)};
    }
    if (cells_of(line) != targets_.size()) refuse_width(line);
    throw ConfigError{
        fmt::format("{}:{}: {} = '{}': not a finite number; repair or cut the run "
                    "there",
                    file_, line_, table_.names[target], shortened(cell))};
  }

  [[noreturn]] void refuse_width(std::string_view line) const {
    throw ConfigError{
        fmt::format("{}:{}: {} cells, the head line names {} columns; repair or cut "
                    "the run there",
                    file_, line_, cells_of(line), targets_.size())};
  }

  std::string_view rest_;
  const std::string& file_;
  std::string_view head_{};
  std::vector<std::size_t> targets_{};  ///< column of the table, by cell
  std::size_t line_ = CsvTable::kFirstRow;
  CsvTable table_{};
};

}  // namespace

std::vector<std::string> csv_names(std::string_view text) {
  text = without_mark(text);
  std::string_view head = take_line(text);
  std::vector<std::string> names(cells_of(head));
  for (std::string& name : names) {
    name = take_cell(head);
  }
  return names;
}

CsvTable parse_csv(std::string_view text,
                   const std::string& file,
                   std::span<const std::string> wanted) {
  return CsvReader{text, file, wanted}.read();
}

CsvTable read_csv(const std::filesystem::path& file, std::span<const std::string> wanted) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw ConfigError{fmt::format("{}: no such file", file.string())};
  }
  const std::ifstream stream{file, std::ios::binary};
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw ConfigError{fmt::format("{}: cannot be read", file.string())};
  return parse_csv(text.str(), file.string(), wanted);
}

}  // namespace teleop
