#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/bench.hpp"
#include "scenarios/bench_tune.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {
namespace {

void add_bench_tune(CLI::App& bench, Action& action) {
  const auto options = std::make_shared<BenchTuneOptions>();
  CLI::App* kind =
      bench.add_subcommand("tune", "the loop-gain tuner on random linear plants, against theory");
  kind->add_option("--cases", options->cases, "how many plants")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  kind->add_option("--seed", options->seed, "of the plants")->capture_default_str();
  kind->add_option("--threads", options->threads, "0: one a core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  kind->add_option("--json", options->json, "write the figures to this file");
  kind->add_option("--csv", options->cases_csv, "write a row a plant to this file");
  kind->callback([&action, options] {
    action = [options] {
      return run_bench_tune(*options);
    };
  });
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* bench = app.add_subcommand("bench", "measure beside a peer or a limit, in one run");
  bench->require_subcommand(1);
  const auto add = [&](const char* name, const char* text, auto run) {
    CLI::App* kind = bench->add_subcommand(name, text);
    kind->add_option("--seconds", options->seconds, "about how long")
        ->check(CLI::Range(0.5, 3600.0))
        ->capture_default_str();
    kind->add_option("--json", options->json, "write the rows to this file");
    kind->callback([&action, options, run] {
      action = [options, run] {
        return run(*options);
      };
    });
  };
  add("diagnose", "one grey-box fit, against scipy's solve_ivp and least_squares", bench_diagnose);
  add("link", "UDP round trip through the whole stack, against a bare socket", bench_link);
  add("loop", "lateness of the loop, against cyclictest", bench_loop);
  add("sim", "simulated pair on simulated time, against real time", bench_sim);
  add_bench_tune(*bench, action);
  add("sweep", "a sweep on two cores, against one", bench_sweep);
}

}  // namespace teleop
