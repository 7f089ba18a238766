#include "scenarios/frequency_response.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <future>
#include <iostream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/identification/response_experiment.hpp"
#include "core/program/stop_signal.hpp"
#include "scenarios/frequency_response_fits.hpp"
#include "scenarios/frequency_response_picture.hpp"
#include "scenarios/gnuplot.hpp"
#include "scenarios/loop_thread.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using nlohmann::json;

ResponseExperiment experiment_of(const FrequencyResponseOptions& options) {
  ResponseExperiment experiment = options.experiment;
  experiment.axis = std::string{"xyz"}.find(options.axis);
  if (options.axis.size() != 1 || experiment.axis >= kJoints) {
    throw ConfigError{fmt::format("--axis {}: must be x, y or z", options.axis)};
  }
  experiment.excitation =
      options.method == "multisine" ? Excitation::multisine : Excitation::stepped_sine;
  check(experiment);
  return experiment;
}

/// A clock and the arm that lives by it: simulated arms live faster unless asked not to.
struct Bench {
  std::unique_ptr<Clock> clock;
  std::unique_ptr<Arm> arm;
};

Bench open(const FrequencyResponseOptions& options) {
  const auto with = [&options](std::unique_ptr<Clock> clock) {
    Bench bench{.clock = std::move(clock), .arm = nullptr};
    bench.arm =
        open_device(options.device, {.clock = *bench.clock, .seed = options.experiment.seed});
    return bench;
  };
  Bench bench = with(std::make_unique<SystemClock>());
  const bool slow = options.real_time || !bench.arm->info().simulated;
  return slow ? std::move(bench) : with(std::make_unique<SimulatedClock>());
}

/// Says what will move and, for an arm that is not simulated, waits for a yes.
void announce(const FrequencyResponseOptions& options,
              const ResponseExperiment& experiment,
              const ArmInfo& info) {
  fmt::print(stderr,
             "{} ({}) will move along {}: at most {:g} mm to each side and {:g} N, about {:.0f} s. "
             "Do not touch it.\n",
             info.name, info.model, options.axis, 1e3 * experiment.max_travel_m,
             experiment.max_force_N, planned_duration_s(experiment));
  if (info.simulated || options.yes) return;
  if (isatty(STDIN_FILENO) == 0) {
    throw ConfigError{"nobody is there to agree that the arm moves: pass --yes"};
  }
  fmt::print(stderr, "Type yes to start: ");
  std::string answer;
  std::getline(std::cin, answer);
  if (answer != "yes") throw ConfigError{"nothing was moved"};
}

ResponseMeasurement measure(const ResponseExperiment& experiment,
                            Bench& bench,
                            const ArmModel& model,
                            bool real_time) {
  StopSignal signal;
  std::atomic<bool> stop{false};
  if (real_time) ask_for_realtime_process();
  auto running = std::async(std::launch::async, [&] {
    if (real_time) ask_for_realtime_thread();
    return measure_response(experiment, *bench.arm, model, *bench.clock, stop);
  });
  while (running.wait_for(0ms) != std::future_status::ready) {
    if (signal.wait(50ms)) stop = true;
  }
  return running.get();
}

std::string table(const FrequencyResponse& response) {
  std::string text =
      "f_Hz,gain_mm_per_N,phase_deg,deviation_mm_per_N,coherence,distortion,odd,even\n";
  for (const ResponseLine& line : response.lines) {
    fmt::format_to(std::back_inserter(text),
                   "{:g},{:.6g},{:.4f},{:.3g},{:.6f},{:.3g},{:.3g},{:.3g}\n", line.f_Hz,
                   1e3 * std::abs(line.gain), std::arg(line.gain) * 180.0 / std::numbers::pi,
                   1e3 * line.deviation, line.coherence, line.distortion, line.odd, line.even);
  }
  return text;
}

json numbers(const FrequencyResponseOptions& options,
             const ResponseMeasurement& measurement,
             const FrequencyResponse& response,
             const std::vector<ResponseModel>& models) {
  json lines = json::array();
  for (const ResponseLine& line : response.lines) {
    lines.push_back({{"f_Hz", line.f_Hz},
                     {"gain", std::abs(line.gain)},
                     {"phase_rad", std::arg(line.gain)},
                     {"deviation", line.deviation},
                     {"coherence", line.coherence},
                     {"distortion", line.distortion},
                     {"odd", line.odd},
                     {"even", line.even}});
  }
  const PeriodicDrive::Outcome& drive = measurement.drives.back();
  return {{"device", options.device},
          {"axis", options.axis},
          {"method", options.method},
          {"rate_Hz", options.experiment.rate_Hz},
          {"seed", options.experiment.seed},
          {"distortion", response.distortion},
          {"distorted", response.distorted},
          {"largest_force_N", drive.largest_force_N},
          {"largest_travel_m", drive.largest_travel_m},
          {"missed_samples", drive.missed},
          {"at_rest", drive.at_rest},
          {"lines", lines},
          {"fits", json_of(models)}};
}

int give_up(const ResponseMeasurement& measurement) {
  const PeriodicDrive::Outcome& last = measurement.drives.back();
  if (last.end == DriveEnd::done) {
    fmt::print(stderr,
               "too many samples were missed ({}): lower --rate-Hz or free the machine; nothing "
               "was written\n",
               last.missed);
  } else {
    fmt::print(stderr,
               "stopped: {} (travel {:.2f} mm, speed {:.2f} m/s, force {:.2f} N); {}; nothing was "
               "written\n",
               text_of(last.end), 1e3 * last.largest_travel_m, last.largest_speed_m_per_s,
               last.largest_force_N,
               last.at_rest ? "the arm is at rest" : "the arm may still be moving");
  }
  return 1;
}

}  // namespace

int run_frequency_response(const FrequencyResponseOptions& options) {
  const ResponseExperiment experiment = experiment_of(options);
  const fs::path folder = make_folder(options.out);
  Bench bench = open(options);
  const ArmModel model = load_arm(bench.arm->info().model);
  announce(options, experiment, bench.arm->info());
  const bool real_time = options.real_time || !bench.arm->info().simulated;

  const ResponseMeasurement measurement = measure(experiment, bench, model, real_time);
  if (!measurement.response) return give_up(measurement);
  const FrequencyResponse& response = *measurement.response;

  const Sampling sampling{.period_s = 1.0 / experiment.rate_Hz,
                          .amplifier_lag_s = 1e-3 * options.amplifier_lag_ms,
                          .delay_samples = options.delay_samples};
  const std::vector<ResponseModel> models = fit_models(measured(response), sampling);
  const std::string name = "frequency-response-" + options.axis;
  const json result = numbers(options, measurement, response, models);
  write_text(folder / (name + ".csv"), table(response));
  write_json(folder / (name + ".json"), result);
  if (!options.json.empty()) write_json(options.json, result);

  std::vector<FittedCurve> curves;
  curves.reserve(models.size());
  for (const ResponseModel& fitted : models) {
    curves.push_back(fitted.curve);
  }
  const std::string title =
      fmt::format("{}, axis {}: {} at {:g} Hz{}", options.device, options.axis, options.method,
                  experiment.rate_Hz, response.distorted ? ", distorted" : "");
  const bool drawn = draw_with_gnuplot(
      folder, name, frequency_response_picture(title, name + ".png", response, curves));
  fmt::print("{} lines from {:g} to {:g} Hz; distortion {:.2f} %{}\n{}", response.lines.size(),
             response.lines.front().f_Hz, response.lines.back().f_Hz, 100.0 * response.distortion,
             response.distorted
                 ? ": not a linear arm at this amplitude, the numbers below are biased by it"
                 : "",
             text_of(models));
  fmt::print("{}\n", (folder / (name + (drawn ? ".png" : ".json"))).string());
  return drawn ? 0 : 1;
}

}  // namespace teleop
