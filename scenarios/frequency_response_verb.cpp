#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/frequency_response.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {
namespace {

void add_limits(CLI::App& verb, FrequencyResponseOptions& options) {
  ResponseExperiment& e = options.experiment;
  verb.add_option_function<double>(
          "--travel-mm", [&e](double mm) { e.max_travel_m = 1e-3 * mm; },
          "farthest from where it stands, any axis; beyond it the drive stops")
      ->check(CLI::Range(0.5, 50.0))
      ->default_str("5");
  verb.add_option("--force-N", e.max_force_N, "largest force at the tool, holding loop included")
      ->check(CLI::Range(0.05, 50.0))
      ->capture_default_str();
  verb.add_option("--gravity-share", e.gravity_share,
                  "of the arm model's weight that is carried; 0 where the arm lies on its side")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_flag("--yes", options.yes, "do not ask before an arm that is not simulated moves");
  verb.add_flag("--real-time", options.real_time, "drive a simulated arm in real time too");
}

void add_excitation(CLI::App& verb, FrequencyResponseOptions& options) {
  ResponseExperiment& e = options.experiment;
  verb.add_option("--method", options.method,
                  "multisine: all lines at once, with intervals and distortion; stepped-sine: one "
                  "after the other")
      ->check(CLI::IsMember({"multisine", "stepped-sine"}))
      ->capture_default_str();
  verb.add_option("--rate-Hz", e.rate_Hz, "of the loop, 100 to 10000")->capture_default_str();
  verb.add_option("--low-Hz", e.low_Hz, "first line")->capture_default_str();
  verb.add_option("--high-Hz", e.high_Hz, "last line, at most 0.4 of the rate")
      ->capture_default_str();
  verb.add_option("--period-s", e.period_s, "of the signal; lines are 2/period apart")
      ->capture_default_str();
  verb.add_option("--periods", e.periods, "kept of every realisation or line")
      ->capture_default_str();
  verb.add_option("--realisations", e.realisations, "of the multisine, with other phases each")
      ->capture_default_str();
  verb.add_option("--lines", e.lines, "of the stepped sine")->capture_default_str();
  verb.add_option("--seed", e.seed, "of lines and phases, and of a simulated arm")
      ->capture_default_str();
}

}  // namespace

void add_frequency_response(CLI::App& app, Action& action) {
  const auto options = std::make_shared<FrequencyResponseOptions>();
  CLI::App* verb = app.add_subcommand(
      "frequency-response", "force to position of one tool axis, with models fitted to it");
  verb->add_option("--device", options->device, "the arm, as for every other verb")
      ->capture_default_str();
  verb->add_option("--axis", options->axis, "of the tool at the start: x, y or z")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  add_limits(*verb, *options);
  add_excitation(*verb, *options);
  verb->add_option("--delay-samples", options->delay_samples,
                   "whole samples from a command to the motor, known of the device")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  verb->add_option("--amplifier-lag-ms", options->amplifier_lag_ms,
                   "first-order lag of the amplifier, known of the device")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  verb->add_option("--out", options->out, "folder for the picture and the numbers")
      ->capture_default_str();
  verb->add_option("--json", options->json, "also write the numbers to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_frequency_response(*options);
    };
  });
}

}  // namespace teleop
