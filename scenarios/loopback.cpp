#include "scenarios/loopback.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/program/stop_signal.hpp"
#include "core/recording/log.hpp"
#include "core/reporting/html.hpp"
#include "core/reporting/metrics.hpp"
#include "core/reporting/words.hpp"
#include "scenarios/child.hpp"
#include "scenarios/output.hpp"
#include "scenarios/summary.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using nlohmann::json;

constexpr int kStart_ms = 5000;
constexpr int kEnd_ms = 5000;

std::vector<std::string> common_arguments(const LoopbackOptions& options, const fs::path& out) {
  std::vector<std::string> arguments{"--status_json", "true",   "--out",
                                     out.string(),    "--seed", std::to_string(options.seed)};
  for (const std::string& file : options.configs) {
    arguments.insert(arguments.end(), {"--config", file});
  }
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw ConfigError{fmt::format("--set {}: must be KEY=VALUE", setting)};
    }
    arguments.insert(arguments.end(),
                     {"--" + setting.substr(0, equals), setting.substr(equals + 1)});
  }
  return arguments;
}

/// The hand that fits the surroundings when none is asked for.
std::string hand_of(const LoopbackOptions& options) {
  if (!options.hand.empty()) return options.hand;
  return options.environment == "free" ? "reach" : "press";
}

fs::path output_folder(const LoopbackOptions& options) {
  const std::time_t now = std::time(nullptr);
  fs::path out = options.out;
  if (out.empty()) out = fmt::format("teleop-{:%Y%m%d-%H%M%S}", fmt::localtime(now));
  for (const char* name : {"master.mcap", "slave.mcap", "report.html"}) {
    if (fs::exists(out / name)) {
      throw ConfigError{fmt::format("{}: exists already; choose another --out or remove it",
                                    (out / name).string())};
    }
  }
  std::error_code error;
  fs::create_directories(out, error);
  if (error || access(out.c_str(), W_OK) != 0) {
    throw ConfigError{fmt::format("{}: cannot be written; choose another --out", out.string())};
  }
  return out;
}

/// So that a run of hours does not end in a figure that cannot be written.
void check_json(const fs::path& file) {
  const fs::path folder = file.parent_path().empty() ? fs::path{"."} : file.parent_path();
  if (file.empty() || access(folder.c_str(), W_OK) == 0) return;
  throw ConfigError{fmt::format("{}: cannot be written; choose another --json", file.string())};
}

std::unique_ptr<Child> start(const std::string& side,
                             std::vector<std::string> own,
                             const std::vector<std::string>& common) {
  std::vector<std::string> command{sibling_program("teleop-" + side)};
  command.insert(command.end(), own.begin(), own.end());
  command.insert(command.end(), common.begin(), common.end());
  return std::make_unique<Child>(side, command);
}

/// The address in a side's first line; its exit code when it never came.
std::string address_of(Child& child, int& failed) {
  const auto line = child.next_line(kStart_ms);
  if (line) return json::parse(*line).at("address").get<std::string>();
  failed = child.end(kEnd_ms);
  if (failed == 0) failed = 1;
  return {};
}

void show_live(const json& master, const json& slave, double seconds) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(
      stderr, "\r\033[K%s",
      fmt::format(
          "{:6.1f} s  master {:<8} slave {:<8}  error {:6.2f} mm  force {:5.2f} N  rtt {:4.0f} us  "
          "late p99 {:4.0f}/{:.0f} us  lost {}",
          seconds, master.value("mode", "?"), slave.value("mode", "?"),
          master.value("error_mm", 0.0), master.value("force_N", 0.0), master.value("rtt_us", 0.0),
          master.value("lateness_p99_us", 0.0), slave.value("lateness_p99_us", 0.0),
          master.value("lost", 0) + slave.value("lost", 0))
          .c_str());
}

/// Runs both until the time is over, one of them ends, or somebody wants to stop.
void watch(Child& master, Child& slave, const LoopbackOptions& options, StopSignal& stop) {
  const auto start = std::chrono::steady_clock::now();
  json of_master = json::object();
  json of_slave = json::object();
  while (true) {
    const double elapsed = seconds(std::chrono::steady_clock::now() - start);
    if (stop.wait(100ms) || elapsed >= options.seconds) break;
    if (master.exit_code() || slave.exit_code()) break;
    if (const auto line = master.newest_line()) of_master = json::parse(*line);
    if (const auto line = slave.newest_line()) of_slave = json::parse(*line);
    show_live(of_master, of_slave, elapsed);
  }
  if (isatty(STDERR_FILENO) != 0) std::fputc('\n', stderr);
}

}  // namespace

int run_loopback(const LoopbackOptions& options) {
  const fs::path out = output_folder(options);
  check_json(options.json);
  const auto common = common_arguments(options, out);
  StopSignal stop;

  int failed = 0;
  const bool two_cores = std::thread::hardware_concurrency() >= 2;
  const std::string master_core = two_cores ? "0" : "-1";
  const std::string slave_core = two_cores ? "1" : "-1";
  const auto slave = start(
      "slave",
      {"--device", options.slave, "--environment", options.environment, "--hand", "none",
       "--link.bind", "127.0.0.1:0", "--loop.core", slave_core, "--link.receive.core", slave_core},
      common);
  const std::string address = address_of(*slave, failed);
  if (failed != 0) return failed;
  const auto master =
      start("master",
            {"--device", options.master, "--hand", hand_of(options), "--link.peer", address,
             "--loop.core", master_core, "--link.receive.core", master_core},
            common);
  (void)address_of(*master, failed);
  if (failed != 0) return failed;

  watch(*master, *slave, options, stop);
  master->ask_to_end();
  const int master_code = master->end(kEnd_ms);
  slave->ask_to_end();
  const int slave_code = slave->end(kEnd_ms);

  std::vector<fs::path> files{out / "master.mcap", out / "slave.mcap"};
  const std::vector<Log> logs{read_log(files[0]), read_log(files[1])};
  const PairMetrics metrics = measure(logs);
  json summary = to_json(metrics);
  summary["recordings"] = {files[0].string(), files[1].string()};
  summary["report"] = nullptr;
  if (options.report) {
    files.push_back(out / "report.html");
    write_report(files.back(), logs, metrics);
    summary["report"] = files.back().string();
  }
  if (!options.json.empty()) write_json(options.json, summary);
  std::fputs(summary_text(metrics, files).c_str(), stdout);
  return master_code != 0 ? master_code : slave_code;
}

}  // namespace teleop
