#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/tune.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {
namespace {

void add_law(CLI::App& verb, TuneOptions& o) {
  verb.add_option("--stiffness-N-per-m", o.stiffness_N_per_m, "fixed stiffness (damping)")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  verb.add_option("--damping-Ns-per-m", o.damping_Ns_per_m, "fixed damping (wall, teleop)")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  verb.add_option("--map", o.map_damping,
                  "K-B map: the largest stable stiffness at each of these dampings, N s/m")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1e3));
  verb.add_option("--velocity", o.velocity, "estimator of velocity, as for the stations")
      ->capture_default_str();
  verb.add_option("--samples", o.mean_samples, "of the estimator 'mean'")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb.add_option("--cutoff-Hz", o.cutoff_Hz, "of the estimator 'difference', 0: none")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  verb.add_option("--peer-delay", o.peer_delay_samples,
                  "age of the other arm's motion in samples (teleop)")
      ->check(CLI::Range(0, 16))
      ->capture_default_str();
}

void add_safety(CLI::App& verb, TuneOptions& o) {
  verb.add_option("--bound-speed-m-per-s", o.bounds.speed_m_per_s, "no probe goes faster")
      ->check(CLI::Range(0.05, 5.0))
      ->capture_default_str();
  verb.add_option("--bound-force-N", o.bounds.force_N, "no probe pushes harder along the axis")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  verb.add_option("--bound-travel-m", o.bounds.travel_m, "no probe leaves its pose further")
      ->check(CLI::Range(1e-3, 0.05))
      ->capture_default_str();
  verb.add_option("--bound-energy-J", o.bounds.energy_J, "that the motors put in, in one probe")
      ->check(CLI::Range(1e-3, 5.0))
      ->capture_default_str();
}

}  // namespace

void add_tune(CLI::App& app, Action& action) {
  const auto options = std::make_shared<TuneOptions>();
  TuneOptions& o = *options;
  CLI::App* verb = app.add_subcommand(
      "tune", "find the loop gain of marginal stability, by small pushes that are watched");
  verb->add_option("--experiment", o.experiment,
                   "wall: a spring to the pose; damping: a virtual damper; teleop: two arms tied "
                   "by position error")
      ->check(CLI::IsMember({"wall", "damping", "teleop"}))
      ->capture_default_str();
  verb->add_option("--device", o.device, "arm (wall, damping): sim[:PLANT]")->capture_default_str();
  verb->add_option("--master", o.master, "arm (teleop)")->capture_default_str();
  verb->add_option("--slave", o.slave, "arm (teleop)")->capture_default_str();
  verb->add_option("--axis", o.axis, "tool axis: x, y, z or all of them")
      ->check(CLI::IsMember({"x", "y", "z", "all"}))
      ->capture_default_str();
  verb->add_option("--points", o.points, "poses spread over the workspace; 1: home")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb->add_option("--hand", o.hand, "on the first simulated arm: none, hold (a pen grip)")
      ->capture_default_str();
  add_law(*verb, o);
  verb->add_option("--amplitude-mm", o.amplitude_mm,
                   "of the oscillation; 0: the larger of 10 counts and 0.3 mm")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  verb->add_option("--width-percent", o.width_percent, "of the 90 % interval at which to stop")
      ->check(CLI::Range(0.2, 50.0))
      ->capture_default_str();
  verb->add_option("--most-arm-seconds", o.most_seconds, "a point may take on the arm")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  verb->add_option("--rate-Hz", o.rate_Hz, "of the loop")
      ->check(CLI::Range(200.0, 10'000.0))
      ->capture_default_str();
  add_safety(*verb, o);
  verb->add_flag("--real-time", o.real_time, "let simulated arms live on the machine's clock");
  verb->add_flag("--resume", o.resume, "go on from the journal tune.jsonl in --out");
  verb->add_option("--seed", o.seed, "of what is random in simulated arms")->capture_default_str();
  verb->add_option("--out", o.out, "folder for tune.json, tune.jsonl and pictures")
      ->capture_default_str();
  verb->add_option("--json", o.json, "also write the result to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_tune(*options);
    };
  });
}

}  // namespace teleop
