#include "scenarios/blind_store.hpp"

#include <cerrno>
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
#include "scenarios/concealed/seal.hpp"
#include "scenarios/output.hpp"

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

Json identity_of(const concealed::ConcealedPlan& plan) {
  return {{"cases", plan.cases}, {"nulls", plan.nulls}, {"seed", plan.seed}};
}

/// Whole lines of a file; what follows the last end of line was torn off.
std::vector<std::string> lines_of(const fs::path& file) {
  const std::string text = read_whole(file);
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    lines.push_back(text.substr(begin, end - begin));
  }
  return lines;
}

std::map<std::string, std::string> read_seals(const fs::path& file) {
  std::map<std::string, std::string> seals;
  for (const std::string& line : lines_of(file)) {
    const std::size_t space = line.find(' ');
    if (space == std::string::npos ||
        !seals.emplace(line.substr(0, space), line.substr(space + 1)).second) {
      throw ConfigError{
          fmt::format("{}: \"{}\": not a line NAME SHA-256, or a second one", file.string(), line)};
    }
  }
  return seals;
}

std::map<std::size_t, std::string> read_lines(const fs::path& file) {
  std::map<std::size_t, std::string> result;
  std::size_t number = 1;
  for (const std::string& line : lines_of(file)) {
    const Json json = Json::parse(line, nullptr, false);
    const bool good = json.is_object() && json.contains("index") && json.contains("case") &&
                      json["index"].is_number_unsigned() && json.contains("truth") &&
                      json.contains("answers");
    if (!good) {
      throw ConfigError{fmt::format("{}:{}: not a case; remove the line to do its case again",
                                    file.string(), number)};
    }
    if (!result.emplace(json["index"].get<std::size_t>(), line).second) {
      throw ConfigError{fmt::format("{}:{}: a second line for {}", file.string(), number,
                                    json["case"].get<std::string>())};
    }
    ++number;
  }
  return result;
}

std::string case_of(const std::string& line) { return Json::parse(line).at("case"); }

/// Opens for appending and cuts a torn end off. @returns the descriptor.
int open_for_lines(const fs::path& file) {
  const int opened = open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (opened < 0) throw ConfigError{fmt::format("{}: cannot be written", file.string())};
  std::size_t whole = 0;
  for (const std::string& line : lines_of(file)) {
    whole += line.size() + 1;
  }
  if (ftruncate(opened, static_cast<off_t>(whole)) != 0) {
    close(opened);
    throw ConfigError{fmt::format("{}: its torn end cannot be cut off", file.string())};
  }
  return opened;
}

void append(int file, const std::string& line, const fs::path& name) {
  const std::string text = line + "\n";
  const auto written = write(file, text.data(), text.size());
  if (std::cmp_not_equal(written, text.size()) || fdatasync(file) != 0) {
    throw Error{fmt::format("{}: cannot be written: {}", name.string(),
                            std::generic_category().message(errno))};
  }
}

}  // namespace

concealed::ConcealedPlan planned_in(const fs::path& folder) {
  const Json identity = Json::parse(read_whole(folder / "blind.json"), nullptr, false);
  try {
    return {
        .cases = identity.at("cases"), .nulls = identity.at("nulls"), .seed = identity.at("seed")};
  } catch (const Json::exception&) {
    throw ConfigError{fmt::format("{}: not the folder of a campaign", folder.string())};
  }
}

std::string truth_of_line(const std::string& line) {
  return Json::parse(line).at("truth").dump(1) + "\n";
}

std::string seal_of_line(const std::string& line) {
  concealed::Seal seal;
  seal.add(truth_of_line(line));
  return seal.digits();
}

BlindStore::BlindStore(fs::path folder, const concealed::ConcealedPlan& plan)
    : folder_{std::move(folder)}, plan_{plan} {
  std::error_code error;
  fs::create_directories(case_folder(), error);
  lock_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || access(folder_.c_str(), W_OK) != 0) {
    throw ConfigError{fmt::format("{}: not a folder that can be written", folder_.string())};
  }
  try {
    begin_or_resume();
  } catch (...) {
    for (const int file : {lock_, results_, published_}) {
      if (file >= 0) close(file);
    }
    throw;
  }
}

BlindStore::~BlindStore() {
  for (const int file : {published_, results_, lock_}) {
    close(file);
  }
}

void BlindStore::begin_or_resume() {
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    throw ConfigError{fmt::format("{}: another campaign is running there", folder_.string())};
  }
  Json identity = identity_of(plan_);
  identity["shard"] = fmt::format("{}/{}", plan_.shard + 1, plan_.shards);
  const fs::path file = folder_ / "blind.json";
  if (!fs::exists(file)) {
    if (fs::exists(folder_ / "cases.jsonl")) {
      throw ConfigError{
          fmt::format("{}: holds something else; choose another --out", folder_.string())};
    }
    write_text(file, identity.dump() + "\n");
  } else if (read_whole(file) != identity.dump() + "\n") {
    throw ConfigError{
        fmt::format("{}: holds another campaign (cases, seed or shard); choose another --out",
                    folder_.string())};
  }
  results_ = open_for_lines(folder_ / "cases.jsonl");
  published_ = open_for_lines(folder_ / "seals.txt");
  seals_ = read_seals(folder_ / "seals.txt");
  lines_ = read_lines(folder_ / "cases.jsonl");
  for (const auto& [index, line] : lines_) {
    if (index >= plan_.cases || !plan_.takes(index)) {
      throw ConfigError{
          fmt::format("{}: {} is not one of this shard", folder_.string(), case_of(line))};
    }
  }
  check_seals();
}

void BlindStore::check_seals() const {
  for (const auto& [index, line] : lines_) {
    const std::string name = case_of(line);
    const auto seal = seals_.find(name);
    if (seal == seals_.end() || seal->second != seal_of_line(line)) {
      throw ConfigError{fmt::format(
          "{}: the truth of {} is not the one that was sealed: truth or seal was changed",
          folder_.string(), name)};
    }
  }
}

std::vector<std::size_t> BlindStore::missing() const {
  std::vector<std::size_t> indices;
  for (std::size_t index = plan_.shard; index < plan_.cases; index += plan_.shards) {
    if (!lines_.contains(index)) indices.push_back(index);
  }
  return indices;
}

void BlindStore::publish(const std::string& name, const std::string& seal) {
  const std::lock_guard lock{turn_};
  const auto [place, is_new] = seals_.emplace(name, seal);
  if (place->second != seal) {
    throw Error{fmt::format("{}: {} was sealed as another device before; choose another --out",
                            folder_.string(), name)};
  }
  if (is_new) append(published_, name + " " + seal, folder_ / "seals.txt");
}

void BlindStore::add(std::size_t index, const std::string& line) {
  const std::lock_guard lock{turn_};
  const std::string name = case_of(line);
  const auto seal = seals_.find(name);
  if (seal == seals_.end() || seal->second != seal_of_line(line)) {
    throw Error{fmt::format("{}: its truth, opened, is not the one that was sealed", name)};
  }
  append(results_, line, folder_ / "cases.jsonl");
  lines_.emplace(index, line);
}

void BlindStore::take(const fs::path& folder) {
  Json identity = Json::parse(read_whole(folder / "blind.json"), nullptr, false);
  if (identity.is_object()) identity.erase("shard");
  if (identity != identity_of(plan_)) {
    throw ConfigError{
        fmt::format("{}: holds another campaign than {}", folder.string(), folder_.string())};
  }
  for (const auto& [name, seal] : read_seals(folder / "seals.txt")) {
    publish(name, seal);
  }
  for (const auto& [index, line] : read_lines(folder / "cases.jsonl")) {
    const auto found = lines_.find(index);
    if (found == lines_.end()) {
      add(index, line);
    } else if (found->second != line) {
      throw ConfigError{fmt::format("{}: another answer for {} than in {}", folder.string(),
                                    case_of(line), folder_.string())};
    }
  }
}

void BlindStore::sort() {
  std::string results;
  for (const auto& [index, line] : lines_) {
    results += line;
    results += '\n';
  }
  std::string seals;
  for (const auto& [name, seal] : seals_) {
    seals += fmt::format("{} {}\n", name, seal);
  }
  write_text(folder_ / "cases.jsonl", results);
  write_text(folder_ / "seals.txt", seals);
}

}  // namespace teleop
