#include "core/identification/response_experiment.hpp"

#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
// Four periods: a late loop may cost two of them.
constexpr Effort kPilot{.periods = 4, .share = 0.35};
constexpr Effort kRehearsal{.periods = 4, .share = 0.5};

PeriodicDrive::Config drive_config(const ResponseExperiment& experiment) {
  return {.axis = experiment.axis,
          .rate_Hz = experiment.rate_Hz,
          .gravity_share = experiment.gravity_share,
          .max_force_N = experiment.max_force_N,
          .max_travel_m = experiment.max_travel_m};
}

FrequencyResponse stepped_response(const ResponseExperiment& experiment,
                                   const LineGrid& grid,
                                   const std::vector<PeriodicRecord>& records,
                                   const RecordInfo& info) {
  FrequencyResponse response;
  const std::vector<std::size_t> lines = stepped_lines(experiment, grid);
  double spurious = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].force_N.cols() < 2) continue;
    response.lines.push_back(
        estimate_sine(records[i], grid.excited[lines[i]], carriers_of(grid), info));
    const ResponseLine& line = response.lines.back();
    spurious += std::norm(line.distortion * line.gain);
    whole += std::norm(line.gain);
  }
  response.distortion = whole > 0.0 ? std::sqrt(spurious / whole) : 0.0;
  response.distorted = response.distortion > kDistorted;
  return response;
}

/// Metres along the axis for one encoder count of every joint that moves it.
double count(const ArmInfo& info, const ArmModel& model, const JointVector& q, std::size_t axis) {
  const Matrix3 J = linear_jacobian(model, q);
  double total = 0.0;
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    total +=
        std::abs(J(static_cast<Eigen::Index>(axis), joint)) * kTwoPi / info.counts_per_rev[joint];
  }
  return total;
}

}  // namespace

void check(const ResponseExperiment& e) {
  const auto refuse = [](const std::string& what) {
    throw ConfigError{"frequency response: " + what};
  };
  if (e.axis >= kJoints) refuse("axis must be x, y or z");
  if (!(e.rate_Hz >= 100.0 && e.rate_Hz <= 10000.0)) refuse("rate must be 100 to 10000 Hz");
  if (!(e.period_s > 0.0 && e.period_s <= 100.0)) {
    refuse("period must be above 0 and at most 100 s");
  }
  if (!(e.low_Hz * e.period_s >= 2.0)) {
    refuse(fmt::format("lowest frequency must be at least {} Hz, two periods of the signal",
                       2.0 / e.period_s));
  }
  if (!(e.high_Hz <= 0.4 * e.rate_Hz)) {
    refuse(
        fmt::format("highest frequency must be at most {} Hz, 0.4 of the rate", 0.4 * e.rate_Hz));
  }
  if (!((e.high_Hz - e.low_Hz) * e.period_s >= 40.0)) {
    refuse("too few lines: widen the band or lengthen the period");
  }
  if (!(e.max_force_N > 0.0 && e.max_travel_m > 0.0)) refuse("force and travel must be positive");
  if (e.periods < 2 || e.realisations < 3 || e.lines < 10) {
    refuse("needs 2 periods, 3 realisations, 10 lines at least");
  }
}

double planned_duration_s(const ResponseExperiment& e) {
  const double settle = static_cast<double>(settle_periods(e));
  const double pieces = e.excitation == Excitation::multisine ? e.realisations : e.lines;
  const double before = 2.0 * settle + kPilot.periods + kRehearsal.periods;
  return 3.0 * PeriodicDrive::overhead_s(drive_config(e)) +
         e.period_s * (before + pieces * (settle + e.periods));
}

ResponseMeasurement measure_response(const ResponseExperiment& experiment,
                                     Arm& arm,
                                     const ArmModel& model,
                                     Clock& clock,
                                     const std::atomic<bool>& stop) {
  check(experiment);
  Random random{experiment.seed};
  const LineGrid grid = grid_of(experiment, random);
  ResponseMeasurement result;
  PeriodicDrive::Config config = drive_config(experiment);
  const Duration period{std::llround(1e9 / experiment.rate_Hz)};
  const auto drive_through = [&](std::vector<PeriodicDrive::Segment> segments) {
    PeriodicDrive drive{config, model, std::move(segments), stop};
    run_periodically(clock, period,
                     [&](const Tick& tick) noexcept { return drive.step(arm, tick); });
    // An arm with weight sinks between drives: all of them are to be at the place of the first.
    config.q_0 = drive.centre();
    result.drives.push_back(drive.outcome());
    std::vector<PeriodicRecord> records = drive.records();
    if (drive.outcome().end != DriveEnd::done) records.clear();
    return records;
  };
  Answer answer = answer_of_lightest(grid, experiment.period_s);
  std::vector<PeriodicRecord> records;
  for (const Effort& effort : {kPilot, kRehearsal}) {
    records = drive_through(multisine_segments(experiment, grid, answer, effort, random));
    if (records.empty() || records.front().force_N.cols() == 0) return result;
    answer = answer_of(grid, records.front());
  }
  const RecordInfo info{
      .rate_Hz = experiment.rate_Hz,
      .count_m =
          count(arm.info(), model, config.q_0.value_or(JointVector::Zero()), experiment.axis)};
  if (experiment.excitation == Excitation::stepped_sine) {
    records = drive_through(stepped_segments(experiment, grid, answer, info.count_m, random));
    FrequencyResponse response = stepped_response(experiment, grid, records, info);
    if (response.lines.size() >= 10) result.response = std::move(response);
    return result;
  }
  // Friction may hold the rehearsal back so much that the measurement goes too far: then less.
  for (const double share : {1.0, 0.6, 0.36}) {
    const Effort effort{
        .realisations = experiment.realisations, .periods = experiment.periods, .share = share};
    records = drive_through(multisine_segments(experiment, grid, answer, effort, random));
    const DriveEnd end = result.drives.back().end;
    if (end != DriveEnd::travel && end != DriveEnd::speed) break;
  }
  std::erase_if(records, [](const PeriodicRecord& record) { return record.force_N.cols() < 2; });
  if (records.size() >= 3) result.response = estimate_multisine(grid, records, info);
  return result;
}

}  // namespace teleop
