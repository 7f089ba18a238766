#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/sweep.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_sweep(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* verb = app.add_subcommand(
      "sweep", "run a scenario over the values that its [sweep] table gives to keys");
  verb->add_option("scenario", options->scenario, "scenario file or a name of the catalogue");
  verb->add_option(
      "--out", options->out,
      "folder of the results; NAME-sweep when not given. Run again on the same folder, "
      "the sweep goes on where it was left");
  verb->add_option("--jobs", options->jobs, "points at a time; 0: one a core")
      ->check(CLI::Range(0, 1024));
  verb->add_option("--shard", options->shard, "i/N: only every N-th point, for N computers")
      ->capture_default_str();
  verb->add_option("--json", options->json, "write a summary for scripts to this file");
  verb->add_flag("--yes", options->yes, "start a real arm unasked; only together with --force");
  verb->add_flag("--force", options->force, "with --yes: nobody beside the arm confirms");
  verb->require_subcommand(0, 1);

  CLI::App* merge = verb->add_subcommand("merge", "put the shards of one sweep together");
  merge->add_option("folders", options->shards, "folders of the shards")->required();
  merge->add_option("--out", options->out, "folder of the whole sweep")->required();
  merge->add_option("--json", options->json, "write a summary for scripts to this file");

  verb->callback([options, &action, merge] {
    if (merge->parsed()) return;
    action = [options] {
      return run_sweep_verb(*options);
    };
  });
  merge->callback([options, &action] {
    action = [options] {
      return merge_sweeps(*options);
    };
  });
}

}  // namespace teleop
