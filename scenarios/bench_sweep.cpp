#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/experiment/sweep.hpp"
#include "scenarios/bench.hpp"
#include "scenarios/scratch.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// So many points that the last one, alone on its core, does not count.
constexpr const char* kSweep = R"(experiment = "teleop"
[run]
seconds = 10.0
[sweep]
[[sweep.axis]]
keys = ["law.stiffness_master_N_per_m", "law.stiffness_slave_N_per_m"]
from = 300
to = 1200
points = 48
)";

/// Points a second.
double speed(const SweepPlan& plan, unsigned jobs) {
  const Scratch scratch;
  SweepStore store{scratch.path(), plan, {}};
  const auto begin = std::chrono::steady_clock::now();
  (void)run_sweep(plan, store, jobs, {});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  return static_cast<double>(plan.size()) / elapsed.count();
}

/// Seconds that so many threads need for the same piece of arithmetic each.
double spin(unsigned threads) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> workers;
  workers.reserve(threads);
  for (unsigned i = 0; i < threads; ++i) {
    workers.emplace_back([] {
      volatile double x = 1.0;
      for (int k = 0; k < 100'000'000; ++k) {
        x = x * 1.000'000'1;
      }
    });
  }
  for (std::thread& worker : workers) {
    worker.join();
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

/// The same sweep on two cores and on one, in turns, so that what else the machine does meets both.
int bench_sweep(const BenchOptions& options) {
  if (std::thread::hardware_concurrency() < 2) {
    throw ConfigError{"bench sweep: this machine has one core; there is nothing to compare"};
  }
  const SweepPlan plan{{.toml = kSweep, .file = "bench sweep"}};
  (void)speed(plan, 2);
  std::vector<double> ratios;
  std::vector<double> one;
  std::vector<double> two;
  const auto begin = std::chrono::steady_clock::now();
  do {
    // Which goes first alternates: a machine that gets busier favours neither.
    const bool one_first = ratios.size() % 2 == 0;
    const double first = speed(plan, one_first ? 1 : 2);
    const double second = speed(plan, one_first ? 2 : 1);
    one.push_back(one_first ? first : second);
    two.push_back(one_first ? second : first);
    ratios.push_back(two.back() / one.back());
    // What bare arithmetic gains tells whether the machine has a second core to give just now.
    fmt::print(stderr,
               "pair {}: {:.1f} points/s on one core, {:.1f} on two, ratio {:.3f}; the machine "
               "itself {:.3f}\n",
               ratios.size(), one.back(), two.back(), ratios.back(), 2.0 * spin(1) / spin(2));
  } while (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() <
           options.seconds);
  report_rows({{.id = "sweep_scaling",
                .ours = median(two),
                .peer = median(one),
                .peer_name = "one core",
                .unit = "1/s",
                .ratio = median(ratios),
                .lower_is_better = false}},
              options);
  return 0;
}

}  // namespace teleop
