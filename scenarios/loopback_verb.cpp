#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/loopback.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_loopback(CLI::App& app, Action& action) {
  const auto options = std::make_shared<LoopbackOptions>();
  CLI::App* verb =
      app.add_subcommand("loopback", "master and slave as two processes on this machine");
  verb->add_option("--seconds", options->seconds, "how long")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  verb->add_option("--master", options->master, "device of the master")->capture_default_str();
  verb->add_option("--slave", options->slave, "device of the slave")->capture_default_str();
  verb->add_option(
      "--hand", options->hand,
      "hand at the master: trace.csv (t_s,q_rad or t_s,x_m,y_m,z_m), reach, press or none; "
      "as fits the environment when not given");
  verb->add_option("--environment", options->environment, "at the slave: free, soft or wall")
      ->check(CLI::IsMember({"free", "soft", "wall"}))
      ->capture_default_str();
  verb->add_option("--out", options->out,
                   "folder for recordings and report; a new one when not given");
  verb->add_option("--json", options->json, "write the summary for scripts to this file");
  verb->add_option("--config", options->configs,
                   "TOML file for both sides; several: later ones win");
  verb->add_option("--set", options->settings,
                   "KEY=VALUE for both sides, as in --print-config of either");
  verb->add_option("--seed", options->seed, "of everything random")->capture_default_str();
  verb->add_flag("!--no-report", options->report, "write no report");
  verb->callback([options, &action] {
    action = [options] {
      return run_loopback(*options);
    };
  });
}

}  // namespace teleop
