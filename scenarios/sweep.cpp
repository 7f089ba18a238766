#include "scenarios/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/experiment/sweep.hpp"
#include "scenarios/listening.hpp"
#include "scenarios/output.hpp"
#include "scenarios/progress_line.hpp"
#include "scenarios/run.hpp"
#include "scenarios/sweep_picture.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

SweepShard shard_of(const std::string& text) {
  SweepShard shard;
  char rest = '\0';
  // NOLINTNEXTLINE(cert-err34-c,cppcoreguidelines-pro-type-vararg): its failures are caught below
  const int read = std::sscanf(text.c_str(), "%6zu/%6zu%c", &shard.i, &shard.n, &rest);
  if (read != 2 || shard.i < 1 || shard.i > shard.n) {
    throw ConfigError{fmt::format("--shard {}: must be i/N with 1 <= i <= N, like 2/8", text)};
  }
  return shard;
}

fs::path folder_of(const SweepOptions& options) {
  if (!options.out.empty()) return options.out;
  return fs::path{options.scenario}.stem().string() + "-sweep";
}

int report(const SweepPlan& plan,
           const SweepStore& store,
           const SweepOptions& options,
           std::size_t ran) {
  const std::size_t missing = store.missing().size();
  if (!options.json.empty()) {
    write_json(options.json, {{"folder", store.folder().string()},
                              {"points", plan.size()},
                              {"finished", store.lines().size()},
                              {"missing", missing},
                              {"ran", ran},
                              {"fingerprint", plan.fingerprint()},
                              {"results", (store.folder() / "results.jsonl").string()}});
  }
  fmt::print("{} points in {}\n", store.lines().size(), (store.folder() / "results.csv").string());
  if (missing == 0) return 0;
  fmt::print(stderr, "{} points are missing; the same command goes on\n", missing);
  return 1;
}

}  // namespace

int run_sweep_verb(const SweepOptions& options) {
  if (options.scenario.empty()) {
    throw ConfigError{"say what to sweep, for example: teleop sweep coupling-stiffness"};
  }
  const SweepShard shard = shard_of(options.shard);
  const ScenarioText text = read_scenario(options.scenario);
  const SweepPlan plan{text};
  const Scenario base{text};
  SystemClock clock;
  std::unique_ptr<Arm> arm;
  if (!base.simulated()) {
    arm = open_device(base.device(), {.clock = clock, .seed = base.seed()});
    confirm_start(arm->info(), fmt::format("{} times {}", plan.size(), base.kind().text),
                  options.yes, options.force);
  }
  SweepStore store{folder_of(options), plan, shard};
  std::atomic<bool> asked{false};
  ProgressLine line{store.lines().size(), "points"};
  const SweepControl control{.stop = &asked,
                             .progress = [&line](std::size_t done, std::size_t total) {
                               line.show(done, total);
                             }};
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t before = store.lines().size();
  bool complete = false;
  run_while_listening(asked, [&] {
    complete = arm != nullptr
                   ? run_sweep_on_arm(plan, store, {.arm = *arm, .clock = clock}, control)
                   : run_sweep(plan, store, options.jobs == 0 ? cores : options.jobs, control);
  });
  bool drawn = true;
  if (complete && shard.n == 1) drawn = draw_sweep(plan, store);
  const int code = report(plan, store, options, store.lines().size() - before);
  return code == 0 && !drawn ? 1 : code;
}

int merge_sweeps(const SweepOptions& options) {
  if (options.out.empty()) throw ConfigError{"sweep merge: --out FOLDER says where to"};
  const fs::path first = options.shards.front();
  ScenarioText text = read_scenario((first / "sweep.toml").string());
  const SweepPlan plan{std::move(text)};
  SweepStore store{options.out, plan, {}};
  for (const std::string& shard : options.shards) {
    store.take(shard);
  }
  const std::vector<std::size_t> missing = store.missing();
  if (!missing.empty()) {
    const std::size_t shown = std::min<std::size_t>(missing.size(), 10);
    throw ConfigError{fmt::format(
        "{} points are in none of the folders (index {}{}); finish their shards, then merge again",
        missing.size(),
        fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < missing.size() ? " ..." : "")};
  }
  store.sort();
  const bool drawn = draw_sweep(plan, store);
  const int code = report(plan, store, options, 0);
  return code == 0 && !drawn ? 1 : code;
}

}  // namespace teleop
