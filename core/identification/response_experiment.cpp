#include "core/identification/response_experiment.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kLightest_kg = 0.02;  ///< the pilot spares the travel of such a tool
constexpr double kPilotShare = 0.3;    ///< of the limits
constexpr double kForceShare = 0.8;    ///< of the limit
constexpr double kTravelShare = 0.7;   ///< of the limit
constexpr std::size_t kPilotPeriods = 2;
constexpr double kSettle_s = 2.0;        ///< the holding loop forgets the start by e⁻¹⁰ or so
constexpr double kCarrierCounts = 20.0;  ///< amplitude of the slow sine beside a small one
constexpr double kSmallCounts = 4.0;     ///< amplitudes below this need it

/// Position and force for a unit of reference, at each excited line.
struct Answer {
  Eigen::VectorXd position_m;
  Eigen::VectorXd force_N;
};

using Amplitudes = std::vector<Complex>;

std::size_t samples_of(const ResponseExperiment& experiment) {
  return static_cast<std::size_t>(std::lround(experiment.rate_Hz * experiment.period_s));
}

std::size_t settle_periods(const ResponseExperiment& experiment) {
  return static_cast<std::size_t>(std::ceil(kSettle_s / experiment.period_s));
}

void check(const ResponseExperiment& e) {
  const auto refuse = [](const std::string& what) {
    throw ConfigError{"frequency response: " + what};
  };
  if (e.axis >= kJoints) refuse("axis must be x, y or z");
  if (!(e.rate_Hz >= 100.0 && e.rate_Hz <= 10000.0)) refuse("rate must be 100 to 10000 Hz");
  if (!(e.period_s > 0.0 && e.period_s <= 100.0))
    refuse("period must be above 0 and at most 100 s");
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

LineGrid grid_of(const ResponseExperiment& experiment, Random& random) {
  const auto line = [&](double f_Hz) {
    return static_cast<std::size_t>(std::lround(f_Hz * experiment.period_s));
  };
  return odd_random_grid(samples_of(experiment), line(experiment.low_Hz), line(experiment.high_Hz),
                         random);
}

Eigen::VectorXcd random_phases(std::size_t count, Random& random) {
  Eigen::VectorXcd phases{static_cast<Eigen::Index>(count)};
  for (Complex& phase : phases) {
    phase = std::polar(1.0, random.uniform(0.0, kTwoPi));
  }
  return phases;
}

double peak(const LineGrid& grid, const Eigen::VectorXcd& spectrum) {
  return periodic_signal(grid.samples, grid.excited,
                         {spectrum.data(), static_cast<std::size_t>(spectrum.size())})
      .cwiseAbs()
      .maxCoeff();
}

/// Line amplitudes min(A_f/|force|, A_y/|position|), with A_f and A_y as large as the limits bear
/// for every one of the phases.
Eigen::VectorXd amplitudes(const LineGrid& grid,
                           const Answer& answer,
                           const std::vector<Eigen::VectorXcd>& phases,
                           double max_force_N,
                           double max_travel_m) {
  constexpr int kRounds = 12;
  double A_f = max_force_N;
  double A_y = max_travel_m;
  Eigen::VectorXd result;
  for (int round = 0; round < kRounds; ++round) {
    result = (A_f * answer.force_N.cwiseInverse()).cwiseMin(A_y * answer.position_m.cwiseInverse());
    double force = 0.0;
    double travel = 0.0;
    for (const Eigen::VectorXcd& phase : phases) {
      force = std::max(force, peak(grid, result.cwiseProduct(answer.force_N).asDiagonal() * phase));
      travel =
          std::max(travel, peak(grid, result.cwiseProduct(answer.position_m).asDiagonal() * phase));
    }
    const double too_much = std::max(force / max_force_N, travel / max_travel_m);
    if (round + 1 == kRounds) return result / std::max(1.0, too_much);
    A_f *= std::clamp(max_force_N / force, 0.5, 1.5);
    A_y *= std::clamp(max_travel_m / travel, 0.5, 1.5);
  }
  return result;
}

Eigen::VectorXd reference(const LineGrid& grid,
                          const Eigen::VectorXd& amplitude,
                          const Eigen::VectorXcd& phases) {
  const Eigen::VectorXcd spectrum = amplitude.cast<Complex>().cwiseProduct(phases);
  return periodic_signal(grid.samples, grid.excited,
                         {spectrum.data(), static_cast<std::size_t>(spectrum.size())});
}

PeriodicDrive::Config drive_config(const ResponseExperiment& experiment) {
  return {.axis = experiment.axis,
          .rate_Hz = experiment.rate_Hz,
          .max_force_N = experiment.max_force_N,
          .max_travel_m = experiment.max_travel_m};
}

PeriodicDrive run(const ResponseExperiment& experiment,
                  const ArmModel& model,
                  std::vector<PeriodicDrive::Segment> segments,
                  std::pair<Arm&, Clock&> device,
                  const std::atomic<bool>& stop) {
  PeriodicDrive drive{drive_config(experiment), model, std::move(segments), stop};
  const Duration period{std::llround(1e9 / experiment.rate_Hz)};
  run_periodically(device.second, period,
                   [&](const Tick& tick) noexcept { return drive.step(device.first, tick); });
  return drive;
}

PeriodicDrive::Segment pilot_segment(const ResponseExperiment& experiment,
                                     const LineGrid& grid,
                                     Random& random) {
  const auto count = static_cast<Eigen::Index>(grid.excited.size());
  Answer light{.position_m = Eigen::VectorXd{count}, .force_N = Eigen::VectorXd::Ones(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double omega = kTwoPi / experiment.period_s *
                         static_cast<double>(grid.excited[static_cast<std::size_t>(i)]);
    light.position_m(i) = 1.0 / (kLightest_kg * omega * omega);
  }
  const std::vector<Eigen::VectorXcd> phases{random_phases(grid.excited.size(), random)};
  const Eigen::VectorXd size = amplitudes(grid, light, phases, kPilotShare * experiment.max_force_N,
                                          kPilotShare * experiment.max_travel_m);
  return {.reference_N = reference(grid, size, phases.front()),
          .settle_periods = settle_periods(experiment),
          .periods = kPilotPeriods};
}

Answer answer_of(const LineGrid& grid, const PeriodicRecord& record) {
  const auto count = static_cast<Eigen::Index>(grid.excited.size());
  const Eigen::VectorXcd R = line_spectrum(record.reference_N, grid.excited.back());
  const Eigen::VectorXcd U = line_spectrum(record.force_N.rowwise().mean(), grid.excited.back());
  const Eigen::VectorXcd Y = line_spectrum(record.position_m.rowwise().mean(), grid.excited.back());
  Answer answer{.position_m = Eigen::VectorXd{count}, .force_N = Eigen::VectorXd{count}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto line = static_cast<Eigen::Index>(grid.excited[static_cast<std::size_t>(i)]);
    answer.position_m(i) = std::max(std::abs(Y(line) / R(line)), 1e-12);
    answer.force_N(i) = std::max(std::abs(U(line) / R(line)), 1e-3);
  }
  return answer;
}

std::vector<PeriodicDrive::Segment> multisine_segments(const ResponseExperiment& experiment,
                                                       const LineGrid& grid,
                                                       const Answer& answer,
                                                       Random& random) {
  std::vector<Eigen::VectorXcd> phases;
  for (int i = 0; i < experiment.realisations; ++i) {
    phases.push_back(random_phases(grid.excited.size(), random));
  }
  const Eigen::VectorXd size =
      amplitudes(grid, answer, phases, kForceShare * experiment.max_force_N,
                 kTravelShare * experiment.max_travel_m);
  std::vector<PeriodicDrive::Segment> segments;
  for (const Eigen::VectorXcd& phase : phases) {
    segments.push_back({.reference_N = reference(grid, size, phase),
                        .settle_periods = settle_periods(experiment),
                        .periods = static_cast<std::size_t>(experiment.periods)});
  }
  return segments;
}

/// Indices into grid.excited, about evenly spaced over ln f.
std::vector<std::size_t> stepped_lines(const ResponseExperiment& experiment, const LineGrid& grid) {
  std::vector<std::size_t> chosen;
  const auto low = static_cast<double>(grid.excited.front());
  const double ratio = static_cast<double>(grid.excited.back()) / low;
  for (int i = 0; i < experiment.lines; ++i) {
    const double line = low * std::pow(ratio, i / (experiment.lines - 1.0));
    const auto at = std::lower_bound(grid.excited.begin(), grid.excited.end(),
                                     static_cast<std::size_t>(std::lround(line)));
    const auto index =
        static_cast<std::size_t>(std::min(at, grid.excited.end() - 1) - grid.excited.begin());
    if (chosen.empty() || chosen.back() != index) chosen.push_back(index);
  }
  return chosen;
}

std::vector<PeriodicDrive::Segment> stepped_segments(const ResponseExperiment& experiment,
                                                     const LineGrid& grid,
                                                     const Answer& answer,
                                                     double quantum_m) {
  std::vector<PeriodicDrive::Segment> segments;
  for (const std::size_t index : stepped_lines(experiment, grid)) {
    const auto at = static_cast<Eigen::Index>(index);
    const double carrier = kCarrierCounts * quantum_m / answer.position_m(0);
    const double carrier_force = carrier * answer.force_N(0);
    const double room = kForceShare * experiment.max_force_N - carrier_force;
    const double size =
        std::min(std::max(room, 0.1 * experiment.max_force_N) / answer.force_N(at),
                 0.5 * kTravelShare * experiment.max_travel_m / answer.position_m(at));
    const bool small = size * answer.position_m(at) < kSmallCounts * quantum_m;
    const std::array<std::size_t, 2> lines{grid.excited[index], grid.excited.front()};
    const std::array<Complex, 2> amplitude{size, small ? carrier : 0.0};
    segments.push_back({.reference_N = periodic_signal(grid.samples, lines, amplitude),
                        .settle_periods = settle_periods(experiment),
                        .periods = static_cast<std::size_t>(experiment.periods)});
  }
  return segments;
}

FrequencyResponse stepped_response(const ResponseExperiment& experiment,
                                   const LineGrid& grid,
                                   const std::vector<PeriodicRecord>& records) {
  FrequencyResponse response;
  const std::vector<std::size_t> lines = stepped_lines(experiment, grid);
  double spurious = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].force_N.cols() < 2) continue;
    response.lines.push_back(estimate_sine(records[i], grid.excited[lines[i]], grid.excited.front(),
                                           experiment.rate_Hz));
    spurious = std::max(spurious, response.lines.back().distortion);
  }
  response.distortion = spurious;
  response.distorted = spurious > kDistorted;
  return response;
}

/// Metres along the axis for one encoder count, the smallest of the joints that move it.
double quantum(const ArmInfo& info, const ArmModel& model, const JointVector& q, std::size_t axis) {
  const Matrix3 J = linear_jacobian(model, q);
  double total = 0.0;
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    total +=
        std::abs(J(static_cast<Eigen::Index>(axis), joint)) * kTwoPi / info.counts_per_rev[joint];
  }
  return total;
}

}  // namespace

double planned_duration_s(const ResponseExperiment& e) {
  const double settle = static_cast<double>(settle_periods(e));
  const double pieces = e.excitation == Excitation::multisine ? e.realisations : e.lines;
  const double ends = 2.0 * PeriodicDrive::overhead_s(drive_config(e));
  return ends +
         e.period_s * (settle + static_cast<double>(kPilotPeriods) + pieces * (settle + e.periods));
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
  const PeriodicDrive pilot =
      run(experiment, model, {pilot_segment(experiment, grid, random)}, {arm, clock}, stop);
  result.pilot = pilot.outcome();
  const std::vector<PeriodicRecord> pilot_records = pilot.records();
  if (result.pilot.end != DriveEnd::done || pilot_records.front().force_N.cols() == 0) {
    return result;
  }
  const Answer answer = answer_of(grid, pilot_records.front());
  const bool stepped = experiment.excitation == Excitation::stepped_sine;
  const double count_m = quantum(arm.info(), model, arm.read().q, experiment.axis);
  const PeriodicDrive drive = run(experiment, model,
                                  stepped ? stepped_segments(experiment, grid, answer, count_m)
                                          : multisine_segments(experiment, grid, answer, random),
                                  {arm, clock}, stop);
  result.drive = drive.outcome();
  if (result.drive.end != DriveEnd::done) return result;

  std::vector<PeriodicRecord> records = drive.records();
  if (stepped) {
    FrequencyResponse response = stepped_response(experiment, grid, records);
    if (response.lines.size() >= 10) result.response = std::move(response);
    return result;
  }
  std::erase_if(records, [](const PeriodicRecord& record) { return record.force_N.cols() < 2; });
  if (records.size() >= 3) {
    result.response = estimate_multisine(grid, records, experiment.rate_Hz);
  }
  return result;
}

}  // namespace teleop
