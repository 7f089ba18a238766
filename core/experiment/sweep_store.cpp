#include "core/experiment/sweep_store.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string read_whole(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ConfigError{fmt::format("{}: cannot be read", file.string())};
  return text.str();
}

/// Whole or not at all.
void replace(const fs::path& file, const std::string& text) {
  const fs::path draft = file.string() + ".part";
  std::ofstream out{draft, std::ios::binary};
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(draft, file, error);
  if (!out || error) throw ConfigError{fmt::format("{}: cannot be written", file.string())};
}

std::string identity_of(const SweepPlan& plan, const SweepShard& shard) {
  return Json{{"fingerprint", plan.fingerprint()},
              {"points", plan.size()},
              {"shard", fmt::format("{}/{}", shard.i, shard.n)}}
      .dump();
}

std::string cell_of(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string{c};
  }
  return quoted + "\"";
}

/// The cells of a line, by column.
std::vector<std::pair<std::string, std::string>> cells_of(const std::string& line) {
  const Json json = Json::parse(line);
  std::vector<std::pair<std::string, std::string>> cells{{"index", cell_of(json.at("index"))},
                                                         {"seed", cell_of(json.at("seed"))}};
  for (const char* part : {"keys", "results"}) {
    for (const auto& [name, value] : json.at(part).items()) {
      cells.emplace_back(name, cell_of(value));
    }
  }
  return cells;
}

std::string row_of(const std::string& line, const std::vector<std::string>& columns) {
  const auto cells = cells_of(line);
  std::string row;
  for (const std::string& column : columns) {
    const auto found = std::find_if(cells.begin(), cells.end(),
                                    [&](const auto& cell) { return cell.first == column; });
    row += (row.empty() ? "" : ",") + (found == cells.end() ? std::string{} : found->second);
  }
  return row + "\n";
}

/// @returns whether a column was new.
bool add_columns(const std::string& line, std::vector<std::string>& columns) {
  const std::size_t before = columns.size();
  for (const auto& [name, value] : cells_of(line)) {
    if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  }
  return columns.size() > before;
}

}  // namespace

std::map<std::size_t, std::string> read_result_lines(const fs::path& file) {
  const std::string text = read_whole(file);
  std::map<std::size_t, std::string> lines;
  std::size_t number = 1;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = text.substr(begin, end - begin);
    const Json json = Json::parse(line, nullptr, false);
    const bool good = json.is_object() && json.contains("index") &&
                      json["index"].is_number_unsigned() && json.contains("seed") &&
                      json.contains("keys") && json.contains("results");
    if (!good) {
      throw ConfigError{fmt::format("{}:{}: not a result; remove the line to run its point again",
                                    file.string(), number)};
    }
    if (!lines.emplace(json["index"].get<std::size_t>(), line).second) {
      throw ConfigError{fmt::format("{}:{}: a second result for point {}", file.string(), number,
                                    json["index"].get<std::size_t>())};
    }
    ++number;
  }
  return lines;
}

SweepStore::SweepStore(fs::path folder, const SweepPlan& plan, const SweepShard& shard)
    : folder_{std::move(folder)}, plan_{plan}, shard_{shard} {
  std::error_code error;
  fs::create_directories(folder_, error);
  lock_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || access(folder_.c_str(), W_OK) != 0) {
    throw ConfigError{fmt::format("{}: not a folder that can be written", folder_.string())};
  }
  try {
    begin_or_resume();
  } catch (...) {
    close(lock_);
    if (results_ >= 0) close(results_);
    throw;
  }
}

SweepStore::~SweepStore() {
  close(results_);
  close(lock_);
}

void SweepStore::begin_or_resume() {
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    throw ConfigError{fmt::format("{}: another sweep is running there", folder_.string())};
  }
  const fs::path results = folder_ / "results.jsonl";
  const fs::path identity_file = folder_ / "sweep.json";
  const std::string identity = identity_of(plan_, shard_) + "\n";
  if (fs::exists(identity_file)) {
    if (read_whole(identity_file) != identity) {
      throw ConfigError{fmt::format(
          "{}: holds another sweep or shard (the file, a plant, the shard or the program's version "
          "has changed since); choose another --out",
          folder_.string())};
    }
  } else {
    if (fs::exists(results)) {
      throw ConfigError{fmt::format("{}: exists already; choose another --out", results.string())};
    }
    replace(folder_ / "sweep.toml", plan_.text().toml);
    replace(identity_file, identity);
  }
  results_ = open(results.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (results_ < 0) throw ConfigError{fmt::format("{}: cannot be written", results.string())};
  lines_ = read_result_lines(results);
  std::size_t whole = 0;
  for (const auto& [index, line] : lines_) {
    if (index >= plan_.size() || !shard_.has(index)) {
      throw ConfigError{
          fmt::format("{}: point {} is not one of this sweep's shard", results.string(), index)};
    }
    whole += line.size() + 1;
  }
  if (ftruncate(results_, static_cast<off_t>(whole)) != 0) {
    throw ConfigError{fmt::format("{}: its torn end cannot be cut off", results.string())};
  }
  if (!lines_.empty()) replace(folder_ / "results.csv", table());
}

std::vector<std::size_t> SweepStore::missing() const {
  std::vector<std::size_t> indices;
  for (std::size_t index = shard_.i - 1; index < plan_.size(); index += shard_.n) {
    if (!lines_.contains(index)) indices.push_back(index);
  }
  return indices;
}

void SweepStore::add(std::size_t index, const Results& results) {
  Json keys = Json::object();
  std::uint64_t seed = plan_.seed(index);
  for (std::size_t i = 0; i < plan_.axes().size(); ++i) {
    for (const std::string& key : plan_.axes()[i].keys) {
      keys[key] = Json::parse(plan_.value(i, index).json);
      if (key == "seed") seed = keys[key].get<std::uint64_t>();
    }
  }
  Json numbers = Json::object();
  for (const Result& result : results) {
    numbers[result.name] = result.value ? Json(*result.value) : Json();
  }
  append(index,
         Json{{"index", index}, {"seed", seed}, {"keys", keys}, {"results", numbers}}.dump());
}

void SweepStore::append(std::size_t index, const std::string& line) {
  const std::string text = line + "\n";
  const auto written = write(results_, text.data(), text.size());
  // A killed process loses nothing without it, and it takes as long as a short point does.
  const Instant now = std::chrono::steady_clock::now();
  const bool due = now - synced_ > std::chrono::seconds{1};
  if (due) synced_ = now;
  if (std::cmp_not_equal(written, text.size()) || (due && fdatasync(results_) != 0)) {
    throw Error{fmt::format("{}: cannot be written: {}", (folder_ / "results.jsonl").string(),
                            std::generic_category().message(errno))};
  }
  lines_.emplace(index, line);
  write_table_row(line);
}

void SweepStore::write_table_row(const std::string& line) {
  if (add_columns(line, columns_)) {
    replace(folder_ / "results.csv", table());
    return;
  }
  std::ofstream out{folder_ / "results.csv", std::ios::binary | std::ios::app};
  out << row_of(line, columns_);
}

std::string SweepStore::table() const {
  std::vector<std::string> columns;
  for (const auto& [index, line] : lines_) {
    add_columns(line, columns);
  }
  std::string text;
  for (const std::string& column : columns) {
    text += (text.empty() ? "" : ",") + column;
  }
  text += "\n";
  for (const auto& [index, line] : lines_) {
    text += row_of(line, columns);
  }
  return text;
}

void SweepStore::take(const fs::path& folder) {
  const auto fingerprint = [](const fs::path& of) {
    const Json identity = Json::parse(read_whole(of / "sweep.json"), nullptr, false);
    return identity.is_object() ? identity.value("fingerprint", "") : std::string{};
  };
  if (fingerprint(folder) != plan_.fingerprint()) {
    throw ConfigError{
        fmt::format("{}: holds another sweep than {}", folder.string(), folder_.string())};
  }
  for (const auto& [index, line] : read_result_lines(folder / "results.jsonl")) {
    const auto found = lines_.find(index);
    if (found == lines_.end()) {
      append(index, line);
    } else if (found->second != line) {
      throw ConfigError{fmt::format("{}: another result for point {} than in {}", folder.string(),
                                    index, folder_.string())};
    }
  }
}

void SweepStore::sort() {
  std::string text;
  for (const auto& [index, line] : lines_) {
    text += line + "\n";
  }
  replace(folder_ / "results.jsonl", text);
  replace(folder_ / "results.csv", table());
}

}  // namespace teleop
