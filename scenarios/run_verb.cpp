#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/run.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_run(CLI::App& app, Action& action) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* verb = app.add_subcommand("run", "run one scenario; without a name, list them");
  verb->add_option("scenario", options->scenario, "scenario file or a name of the catalogue");
  verb->add_option("--set", options->settings,
                   "KEY=VALUE instead of what the file says, as in --print-config");
  verb->add_option("--out", options->out, "folder for results.json, pictures and their data");
  verb->add_option("--json", options->json, "write the results to this file");
  verb->add_flag("--print-config", options->print, "print every key of the scenario and end");
  verb->add_flag("--yes", options->yes, "start a real arm unasked; only together with --force");
  verb->add_flag("--force", options->force, "with --yes: nobody beside the arm confirms");
  verb->callback([options, &action] {
    action = [options] {
      return run_scenario(*options);
    };
  });
}

}  // namespace teleop
