#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/bench.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

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
  add("link", "UDP round trip through the whole stack, against a bare socket", bench_link);
  add("loop", "lateness of the loop, against cyclictest", bench_loop);
  add("sim", "simulated pair on simulated time, against real time", bench_sim);
  add("sweep", "a sweep on two cores, against one", bench_sweep);
}

}  // namespace teleop
