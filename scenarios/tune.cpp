#include "scenarios/tune.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/model/workspace.hpp"
#include "core/program/stop_signal.hpp"
#include "core/realtime/clock.hpp"
#include "core/tuning/pose_move.hpp"
#include "scenarios/gnuplot.hpp"
#include "scenarios/loop_thread.hpp"
#include "scenarios/output.hpp"
#include "scenarios/tune_journal.hpp"
#include "scenarios/tune_report.hpp"
#include "scenarios/tune_theory.hpp"

namespace teleop {
namespace {

/// The arms of a run, opened, with what is known of them.
struct Bench {
  std::unique_ptr<Clock> clock;
  bool time_waits = false;
  std::vector<std::string> names;
  std::vector<std::unique_ptr<Arm>> arms;
  std::vector<ArmModel> models;
};

GainExperiment experiment_of(const TuneOptions& options) {
  for (const GainExperiment e :
       {GainExperiment::wall, GainExperiment::damping, GainExperiment::teleop}) {
    if (options.experiment == name_of(e)) return e;
  }
  throw ConfigError{fmt::format(
      "--experiment {}: no such experiment; there are wall, damping, teleop", options.experiment)};
}

void check(const TuneOptions& options) {
  const bool damps = experiment_of(options) == GainExperiment::damping;
  if (damps && (options.damping_Ns_per_m != 0.0 || !options.map_damping.empty())) {
    throw ConfigError{"--damping-Ns-per-m, --map: the damping is what this experiment looks for"};
  }
  if (!damps && options.stiffness_N_per_m != 0.0) {
    throw ConfigError{"--stiffness-N-per-m: the stiffness is what this experiment looks for"};
  }
  if (options.hand != "none" && options.points > 1) {
    throw ConfigError{"--hand: it holds the tool at home and would not let go; take --points 1"};
  }
}

bool is_simulated(const std::string& name) { return name == "sim" || name.starts_with("sim:"); }

Bench open_bench(const TuneOptions& options) {
  Bench bench;
  const bool pair = experiment_of(options) == GainExperiment::teleop;
  bench.names = pair ? std::vector<std::string>{options.master, options.slave}
                     : std::vector<std::string>{options.device};
  bench.time_waits =
      !options.real_time && std::all_of(bench.names.begin(), bench.names.end(), is_simulated);
  if (bench.time_waits) {
    bench.clock = std::make_unique<SimulatedClock>();
  } else {
    bench.clock = std::make_unique<SystemClock>();
  }
  for (const std::string& name : bench.names) {
    // One hand: on the first arm.
    const bool held = bench.arms.empty();
    bench.arms.push_back(open_device(name, {.clock = *bench.clock,
                                            .hand = held ? options.hand : "none",
                                            .seed = options.seed + bench.arms.size()}));
    bench.models.push_back(load_arm(bench.arms.back()->info().model));
  }
  return bench;
}

std::vector<TuneJob> jobs_of(const TuneOptions& options, const ArmModel& model) {
  const std::vector<double> dampings = options.map_damping.empty()
                                           ? std::vector<double>{options.damping_Ns_per_m}
                                           : options.map_damping;
  std::vector<TuneJob> jobs;
  for (const JointVector& q : spread_poses(model, static_cast<std::size_t>(options.points))) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (options.axis != "all" && options.axis != axis_name(axis)) continue;
      for (const double damping : dampings) {
        jobs.push_back({.q = q, .axis = axis, .damping_Ns_per_m = damping});
      }
    }
  }
  if (jobs.empty()) {
    throw ConfigError{fmt::format("--axis {}: no such axis; there are x, y, z, all", options.axis)};
  }
  return jobs;
}

nlohmann::json asked_of(const TuneOptions& o,
                        const Bench& bench,
                        const std::vector<TuneJob>& jobs) {
  nlohmann::json list = nlohmann::json::array();
  for (const TuneJob& job : jobs) {
    list.push_back({{"q", {job.q[0], job.q[1], job.q[2]}},
                    {"axis", job.axis},
                    {"damping_Ns_per_m", job.damping_Ns_per_m}});
  }
  return {
      {"experiment", o.experiment},
      {"devices", bench.names},
      {"hand", o.hand},
      {"velocity", {o.velocity, o.mean_samples, o.cutoff_Hz}},
      {"law", {o.stiffness_N_per_m, o.peer_delay_samples}},
      {"search", {o.amplitude_mm, o.width_percent, o.most_seconds, o.rate_Hz}},
      {"bounds", {o.bounds.speed_m_per_s, o.bounds.force_N, o.bounds.travel_m, o.bounds.energy_J}},
      {"real_time", !bench.time_waits},
      {"seed", o.seed},
      {"jobs", list}};
}

PointConfig point_config(const TuneOptions& options, const TuneJob& job) {
  PointConfig config;
  config.experiment = {.experiment = experiment_of(options),
                       .axis = job.axis,
                       .stiffness_N_per_m = options.stiffness_N_per_m,
                       .damping_Ns_per_m = job.damping_Ns_per_m,
                       .peer_delay_samples = options.peer_delay_samples};
  config.experiment.velocity.kind = options.velocity;
  config.experiment.velocity.mean.samples = options.mean_samples;
  config.experiment.velocity.difference.cutoff_Hz = options.cutoff_Hz;
  config.search.width = 0.01 * options.width_percent;
  config.search.most_arm_seconds = options.most_seconds;
  config.bounds = options.bounds;
  config.amplitude_m = 1e-3 * options.amplitude_mm;
  return config;
}

void show(std::size_t job,
          std::size_t count,
          std::size_t number,
          const ProbeResult& p,
          std::string_view unit) {
  const std::string growth =
      p.oscillation ? fmt::format("{:+8.2f} ± {:.2f} 1/s at {:.1f} Hz", p.oscillation->growth_per_s,
                                  p.oscillation->growth_std_per_s, p.oscillation->frequency_Hz)
                    : "";
  fmt::print(stderr, "point {} of {}, probe {:>2}: {:>9.4g} {}  {:<9} {:<9} {}\n", job + 1, count,
             number, p.plan.gain, unit, name_of(p.verdict), name_of(p.outcome.stop), growth);
}

std::vector<std::pair<double, double>> theory_curve(const TuneOptions& options,
                                                    const Bench& bench,
                                                    const TunedPoint& point) {
  const double most = *std::max_element(options.map_damping.begin(), options.map_damping.end());
  std::vector<std::pair<double, double>> curve;
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i) {
    TuneJob job = point.job;
    job.damping_Ns_per_m = 1.1 * most * i / kSteps;
    const auto margin = theory_of({.devices = bench.names,
                                   .q = job.q,
                                   .experiment = point_config(options, job).experiment,
                                   .amplitude_m = point.result.amplitude_m,
                                   .period_s = 1.0 / options.rate_Hz});
    if (!margin) return {};
    curve.emplace_back(job.damping_Ns_per_m, margin->gain);
  }
  return curve;
}

bool draw(const TuneOptions& options,
          const Bench& bench,
          const std::vector<TunedPoint>& points,
          const std::filesystem::path& folder) {
  const std::size_t worst = worst_of(points);
  if (worst == points.size()) return true;
  bool drawn = draw_with_gnuplot(folder, "search", search_picture(options, points[worst]));
  if (options.points > 1) {
    const auto outline = workspace_outline(bench.models[0], 5e-3);
    drawn = draw_with_gnuplot(folder, "gains", workspace_gains_picture(options, points, outline)) &&
            drawn;
  }
  if (!options.map_damping.empty()) {
    const auto theory = theory_curve(options, bench, points[worst]);
    drawn = draw_with_gnuplot(folder, "kb", kb_picture(options, points, theory)) && drawn;
  }
  return drawn;
}

void go_to(const Bench& bench, const JointVector& q, double period_s) {
  std::vector<MovedArm> moved;
  moved.reserve(bench.arms.size());
  for (std::size_t i = 0; i < bench.arms.size(); ++i) {
    moved.push_back({.arm = bench.arms[i].get(), .model = &bench.models[i]});
  }
  move_to(moved, *bench.clock, q, {.period_s = period_s});
}

/// What cannot be had is refused before anything moves.
void check_estimator(const TuneOptions& options) {
  const PointConfig config = point_config(options, {});
  (void)VelocityEstimator{config.experiment.velocity, JointVector::Constant(1e4)};
}

/// One search: to the pose, the probes, and what theory says.
TunedPoint tune_job(const TuneOptions& options,
                    Bench& bench,
                    const TuneJob& job,
                    const PointConfig& config,
                    std::vector<ProbeResult> history) {
  ProbeRunner::Ports ports{.clock = bench.clock.get(),
                           .time_waits = bench.time_waits,
                           .period_s = 1.0 / options.rate_Hz};
  std::vector<ToolFrame> frames;
  for (std::size_t i = 0; i < bench.arms.size(); ++i) {
    Arm& arm = *bench.arms[i];
    frames.push_back(frame_at(bench.models[i], arm.info(), job.q));
    ports.arms.push_back(&arm);
  }
  go_to(bench, job.q, ports.period_s);
  TunedPoint point{.job = job};
  point.result = tune_point(config, frames, ports, std::move(history));
  const auto theory = theory_of({.devices = bench.names,
                                 .q = job.q,
                                 .experiment = config.experiment,
                                 .amplitude_m = point.result.amplitude_m,
                                 .period_s = ports.period_s});
  if (theory && options.hand == "none") point.analytic_gain = theory->gain;
  return point;
}

/// All searches, one after the other, and home.
std::vector<TunedPoint> tune_all(const TuneOptions& options,
                                 Bench& bench,
                                 const std::vector<TuneJob>& jobs,
                                 TuneJournal& journal,
                                 StopSignal& stop) {
  const std::string_view unit = unit_of(experiment_of(options));
  std::vector<TunedPoint> points;
  points.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    PointConfig config = point_config(options, jobs[i]);
    std::size_t number = journal.done(i).size();
    config.stop_asked = [&] {
      return stop.wait(Duration{0});
    };
    config.on_probe = [&](const ProbeResult& probe) {
      journal.append(i, probe);
      show(i, jobs.size(), ++number, probe, unit);
    };
    points.push_back(tune_job(options, bench, jobs[i], config, journal.done(i)));
    if (points.back().result.stopped) break;
  }
  // Home, where the weight is balanced best, before the amplifiers go off.
  go_to(bench, JointVector::Zero(), 1.0 / options.rate_Hz);
  for (const auto& arm : bench.arms) {
    arm->amplifiers(false);
  }
  return points;
}

}  // namespace

int run_tune(const TuneOptions& options) {
  check(options);
  check_estimator(options);
  StopSignal stop;
  Bench bench = open_bench(options);
  const std::vector<TuneJob> jobs = jobs_of(options, bench.models[0]);
  const std::filesystem::path folder = make_folder(options.out);
  TuneJournal journal{folder / "tune.jsonl", asked_of(options, bench, jobs), options.resume};
  for (const auto& arm : bench.arms) {
    fmt::print(stderr, "{}: {}\n", arm->info().name, arm->info().details);
  }

  const auto tuned = [&] {
    return tune_all(options, bench, jobs, journal, stop);
  };
  const std::vector<TunedPoint> points = bench.time_waits ? tuned() : on_realtime_thread(tuned);

  const nlohmann::json json = report_json(options, points);
  write_json(folder / "tune.json", json);
  if (!options.json.empty()) write_json(options.json, json);
  const bool drawn = draw(options, bench, points, folder);
  fmt::print("{}", report_table(options, points));
  const bool complete = std::all_of(points.begin(), points.end(), [](const TunedPoint& p) {
    return p.result.crossing && !p.result.stopped;
  });
  if (points.back().result.stopped) {
    fmt::print(stderr, "stopped; --resume goes on from {}\n", (folder / "tune.jsonl").string());
  }
  return complete && drawn && points.size() == jobs.size() ? 0 : 1;
}

}  // namespace teleop
