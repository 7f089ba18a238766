#include "scenarios/blind.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/diagnosis/parallel.hpp"
#include "scenarios/blind_case.hpp"
#include "scenarios/blind_report.hpp"
#include "scenarios/blind_store.hpp"
#include "scenarios/child.hpp"
#include "scenarios/listening.hpp"
#include "scenarios/output.hpp"
#include "scenarios/progress_line.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

concealed::ConcealedPlan plan_of(const BlindOptions& options) {
  concealed::ConcealedPlan plan = options.plan;
  char rest = '\0';
  // NOLINTNEXTLINE(cert-err34-c,cppcoreguidelines-pro-type-vararg): its failures are caught below
  const int read =
      std::sscanf(options.shard.c_str(), "%6zu/%6zu%c", &plan.shard, &plan.shards, &rest);
  if (read != 2 || plan.shard < 1 || plan.shard > plan.shards) {
    throw ConfigError{
        fmt::format("--shard {}: must be i/N with 1 <= i <= N, like 2/8", options.shard)};
  }
  --plan.shard;
  return plan;
}

std::string folder_of(const BlindOptions& options) {
  if (!options.out.empty()) return options.out;
  return fmt::format("{}-{}", options.plan.nulls ? "nulls" : "blind", options.plan.seed);
}

void report(const BlindStore& store,
            const concealed::ConcealedPlan& plan,
            const BlindOptions& options) {
  if (store.lines().empty()) return;
  const BlindReport report = score_lines(store.lines(), plan);
  const TableStyle style = options.markdown ? TableStyle::markdown : TableStyle::plain;
  fmt::print("{} of {} {}, seed {}, SHA-256 of the truths {}\n\n", store.lines().size(), plan.cases,
             plan.nulls ? "nulls" : "cases", plan.seed,
             report.sealed.empty() ? "when all are done" : report.sealed);
  for (const TextTable& table : tables_of(report.contestants)) {
    fmt::print("{}", text_of(table, style));
  }
  if (report.missed.rows.size() > 1) fmt::print("{}", text_of(report.missed, style));
  if (!options.json.empty()) {
    write_json(options.json, nlohmann::json(json_of(report, plan, store.lines().size())));
  }
}

/// Hours later would be too late to find out.
void check_json(const std::string& file) {
  if (file.empty()) return;
  const fs::path folder = fs::absolute(file).parent_path();
  if (!fs::is_directory(folder)) {
    throw ConfigError{fmt::format("--json {}: there is no folder {}", file, folder.string())};
  }
}

}  // namespace

int run_blind(const BlindOptions& options) {
  const concealed::ConcealedPlan plan = plan_of(options);
  check_json(options.json);
  BlindStore store{folder_of(options), plan};
  const std::vector<std::size_t> missing = store.missing();
  const std::size_t before = store.lines().size();
  const std::size_t total = before + missing.size();
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t at_a_time =
      std::clamp<std::size_t>(missing.size(), 1, options.threads == 0 ? cores : options.threads);
  std::atomic<bool> asked{false};
  std::atomic<std::size_t> done{before};
  std::mutex showing;
  ProgressLine line{before, "cases"};
  const BlindWork work{
      .plan = plan,
      .store = store,
      .diagnose = options.diagnose.empty() ? sibling_program("teleop") : options.diagnose,
      .threads = std::max(1U, cores / static_cast<unsigned>(at_a_time)),
      .keep = options.keep,
      .stop = asked};
  run_while_listening(asked, [&] {
    for_each_index(missing.size(), at_a_time, [&](std::size_t i) {
      if (asked || !do_blind_case(work, missing[i])) return;
      const std::size_t now = ++done;
      const std::lock_guard lock{showing};
      line.show(now, total);
    });
  });
  const bool complete = store.missing().empty();
  if (complete) store.sort();
  report(store, plan, options);
  if (!complete) {
    fmt::print(stderr, "{} cases are missing; the same command goes on\n", store.missing().size());
  }
  return complete ? 0 : 1;
}

int merge_blind(const BlindOptions& options) {
  check_json(options.json);
  if (options.out.empty()) throw ConfigError{"blind merge: --out FOLDER says where to"};
  const concealed::ConcealedPlan plan = planned_in(options.shards.front());
  BlindStore store{options.out, plan};
  for (const std::string& shard : options.shards) {
    store.take(shard);
  }
  const std::vector<std::size_t> missing = store.missing();
  if (!missing.empty()) {
    const std::size_t shown = std::min<std::size_t>(missing.size(), 10);
    throw ConfigError{fmt::format(
        "{} cases are in none of the folders (index {}{}); finish their shards, then merge again",
        missing.size(),
        fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
        shown < missing.size() ? " ..." : "")};
  }
  store.sort();
  report(store, plan, options);
  return 0;
}

}  // namespace teleop
