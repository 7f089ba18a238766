#include "scenarios/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/recording/log.hpp"
#include "core/reporting/html.hpp"
#include "core/reporting/metrics.hpp"
#include "core/reporting/words.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// The same file, under whatever name and whether or not it is there yet.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal() ||
         fs::equivalent(a, b, error);
}

/// Before anything is read or written: a long run is not analysed for an output that is refused.
void check_output(const fs::path& file, const std::vector<std::string>& logs) {
  for (const std::string& log : logs) {
    if (same_file(file, log)) {
      throw ConfigError{
          fmt::format("{}: is one of the recordings; choose another name", file.string())};
    }
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path{"."};
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw ConfigError{fmt::format("{}: the folder {} does not exist; make it or choose another",
                                  file.string(), folder.string())};
  }
  if (fs::is_directory(file, error)) {
    throw ConfigError{fmt::format("{}: is a folder; give the name of a file", file.string())};
  }
}

}  // namespace

int run_report(const std::vector<std::string>& logs, fs::path out, const fs::path& json) {
  if (logs.empty()) throw ConfigError{"report: no recording given; name one or two"};
  if (out.empty()) out = fs::path{logs.front()}.replace_filename("report.html");
  check_output(out, logs);
  if (!json.empty()) {
    check_output(json, logs);
    if (same_file(out, json)) {
      throw ConfigError{fmt::format(
          "{}: is to hold both the page and the numbers; choose two names", json.string())};
    }
  }

  std::vector<Log> runs;
  runs.reserve(logs.size());
  for (const std::string& log : logs) {
    runs.push_back(read_log(log));
  }
  const PairMetrics metrics = measure(runs);
  write_report(out, runs, metrics);
  if (!json.empty()) {
    nlohmann::json numbers = to_json(metrics);
    numbers["recordings"] = logs;
    numbers["report"] = out.string();
    write_json(json, numbers);
  }

  const Words words = describe(metrics);
  fmt::print("{}\n", words.headline);
  for (const std::string& sentence : words.story) {
    fmt::print("  {}\n", sentence);
  }
  for (const std::string& trouble : words.troubles) {
    fmt::print("  ! {}\n", trouble);
  }
  fmt::print("{}\n", out.string());
  return 0;
}

}  // namespace teleop
