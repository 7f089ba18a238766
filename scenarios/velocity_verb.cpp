#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/velocity.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_velocity(CLI::App& app, Action& action) {
  const auto options = std::make_shared<VelocityOptions>();
  CLI::App* verb = app.add_subcommand(
      "velocity", "velocity estimators side by side: noise, lag, error, the damping they allow");
  verb->add_option("logs", options->logs, "recordings; without any an arm is read, motors off");
  verb->add_option("--device", options->device,
                   "that arm: sim[:PLANT], of which the truth is known; move another by hand")
      ->capture_default_str();
  verb->add_option("--hand", options->hand,
                   "what moves a simulated one: reach, press or a trace file")
      ->capture_default_str();
  verb->add_flag("--real-time", options->real_time,
                 "read a simulated arm on the machine's clock, with its jitter");
  verb->add_option("--seed", options->seed, "of that motion")->capture_default_str();
  verb->add_option("--seconds", options->seconds, "how long to read")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  verb->add_option("--rate-Hz", options->rate_Hz, "readings a second")
      ->check(CLI::Range(100.0, 10000.0))
      ->capture_default_str();
  verb->add_option("--arm", options->arm, "arm of the recordings; what they name when not given");
  verb->add_option("--reference-Hz", options->reference_Hz,
                   "bandwidth of the zero-phase reference where there is no truth")
      ->check(CLI::Range(1.0, 200.0))
      ->capture_default_str();
  verb->add_option("--set", options->settings,
                   "KEY=VALUE of an estimator, as for the stations: velocity.period.samples=8")
      ->allow_extra_args(false);
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
