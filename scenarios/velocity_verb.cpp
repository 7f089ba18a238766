#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/velocity.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_velocity(CLI::App& app, Action& action) {
  const auto options = std::make_shared<VelocityOptions>();
  CLI::App* verb = app.add_subcommand(
      "velocity", "velocity estimators side by side: noise, lag, error, the damping they allow");
  verb->add_option("logs", options->logs,
                   "recordings; without any a simulated motion, of which the truth is known");
  verb->add_option("--device", options->device, "simulated arm that moves: sim[:PLANT]")
      ->capture_default_str();
  verb->add_option("--hand", options->hand, "what moves it: reach, press or a trace file")
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "of that motion")->capture_default_str();
  verb->add_option("--seconds", options->seconds, "of that motion")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  verb->add_option("--rate-Hz", options->rate_Hz, "readings a second of that motion")
      ->check(CLI::Range(100.0, 10000.0))
      ->capture_default_str();
  verb->add_option("--arm", options->arm, "arm of the recordings; what they name when not given");
  verb->add_option("--reference-Hz", options->reference_Hz,
                   "bandwidth of the zero-phase reference of recordings")
      ->check(CLI::Range(1.0, 200.0))
      ->capture_default_str();
  verb->add_option("--set", options->settings,
                   "KEY=VALUE of an estimator, as for the stations: velocity.period.samples=8");
  verb->add_flag("--print-config", options->print_config,
                 "print the estimators' settings and do nothing else");
  verb->add_option("--mass-g", options->mass_g,
                   "tool mass in the damping loop; 0: the arm's own at home, an axis at a time")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  verb->add_option("--damping-Ns-per-m", options->damping_Ns_per_m,
                   "physical damping of the tool in that loop")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  verb->add_option("--amplitude-mm", options->amplitude_mm,
                   "of the oscillation at its margin; 0: 10 counts, at least 0.3 mm")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  verb->add_option("--out", options->out, "folder for the pictures")->capture_default_str();
  verb->add_option("--json", options->json, "also write the numbers to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_velocity(*options);
    };
  });
}

}  // namespace teleop
