#include "core/identification/excitation_design.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kLightest_kg = 0.02;
constexpr double kForceShare = 0.8;     ///< of the limit
constexpr double kTravelShare = 0.7;    ///< of the limit
constexpr double kSettle_s = 2.0;       ///< the holding loop forgets the start by e⁻¹⁰ or so
constexpr double kCarrierCounts = 8.0;  ///< amplitude of each slow line beside a sine
constexpr std::size_t kCarriers = 5;

std::size_t samples_of(const ResponseExperiment& experiment) {
  return static_cast<std::size_t>(std::lround(experiment.rate_Hz * experiment.period_s));
}

double peak(const LineGrid& grid, const Eigen::VectorXcd& spectrum) {
  return periodic_signal(grid.samples, grid.excited,
                         {spectrum.data(), static_cast<std::size_t>(spectrum.size())})
      .cwiseAbs()
      .maxCoeff();
}

/// Random phases; of a few draws the one whose force has the lowest peak for its power.
Eigen::VectorXcd random_phases(const LineGrid& grid, Random& random) {
  constexpr int kDraws = 12;
  Eigen::VectorXcd best;
  double lowest = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXcd phases{static_cast<Eigen::Index>(grid.excited.size())};
    for (Complex& phase : phases) {
      phase = std::polar(1.0, random.uniform(0.0, kTwoPi));
    }
    const double height = peak(grid, phases);
    if (draw > 0 && height >= lowest) continue;
    lowest = height;
    best = phases;
  }
  return best;
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

}  // namespace

LineGrid grid_of(const ResponseExperiment& experiment, Random& random) {
  const auto line = [&](double f_Hz) {
    return static_cast<std::size_t>(std::lround(f_Hz * experiment.period_s));
  };
  return odd_random_grid(samples_of(experiment), line(experiment.low_Hz), line(experiment.high_Hz),
                         random);
}

std::size_t settle_periods(const ResponseExperiment& experiment) {
  return static_cast<std::size_t>(std::ceil(kSettle_s / experiment.period_s));
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

Answer answer_of_lightest(const LineGrid& grid, double period_s) {
  const auto count = static_cast<Eigen::Index>(grid.excited.size());
  Answer answer{.position_m = Eigen::VectorXd{count}, .force_N = Eigen::VectorXd::Ones(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double omega =
        kTwoPi / period_s * static_cast<double>(grid.excited[static_cast<std::size_t>(i)]);
    answer.position_m(i) = 1.0 / (kLightest_kg * omega * omega);
  }
  return answer;
}

std::vector<PeriodicDrive::Segment> multisine_segments(const ResponseExperiment& experiment,
                                                       const LineGrid& grid,
                                                       const Answer& answer,
                                                       const Effort& effort,
                                                       Random& random) {
  std::vector<Eigen::VectorXcd> phases;
  phases.reserve(static_cast<std::size_t>(effort.realisations));
  for (int i = 0; i < effort.realisations; ++i) {
    phases.push_back(random_phases(grid, random));
  }
  const Eigen::VectorXd size =
      amplitudes(grid, answer, phases, effort.share * kForceShare * experiment.max_force_N,
                 effort.share * kTravelShare * experiment.max_travel_m);
  std::vector<PeriodicDrive::Segment> segments;
  segments.reserve(phases.size());
  for (const Eigen::VectorXcd& phase : phases) {
    segments.push_back({.reference_N = reference(grid, size, phase),
                        .settle_periods = settle_periods(experiment),
                        .periods = static_cast<std::size_t>(effort.periods)});
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

std::span<const std::size_t> carriers_of(const LineGrid& grid) {
  return {grid.excited.data(), std::min<std::size_t>(kCarriers, grid.excited.size())};
}

std::vector<PeriodicDrive::Segment> stepped_segments(const ResponseExperiment& experiment,
                                                     const LineGrid& grid,
                                                     const Answer& answer,
                                                     double count_m,
                                                     Random& random) {
  const std::span<const std::size_t> carriers = carriers_of(grid);
  std::vector<PeriodicDrive::Segment> segments;
  for (const std::size_t index : stepped_lines(experiment, grid)) {
    const auto at = static_cast<Eigen::Index>(index);
    std::vector<std::size_t> lines{carriers.begin(), carriers.end()};
    std::vector<Complex> sizes;
    double carrier_force = 0.0;
    for (std::size_t i = 0; i < carriers.size(); ++i) {
      const auto carrier = static_cast<Eigen::Index>(i);
      const double size = kCarrierCounts * count_m / answer.position_m(carrier);
      sizes.push_back(std::polar(size, random.uniform(0.0, kTwoPi)));
      carrier_force += size * answer.force_N(carrier);
    }
    const double room = kForceShare * experiment.max_force_N - carrier_force;
    const double size =
        std::min(std::max(room, 0.1 * experiment.max_force_N) / answer.force_N(at),
                 0.5 * kTravelShare * experiment.max_travel_m / answer.position_m(at));
    lines.push_back(grid.excited[index]);
    sizes.emplace_back(size);
    segments.push_back({.reference_N = periodic_signal(grid.samples, lines, sizes),
                        .settle_periods = settle_periods(experiment),
                        .periods = static_cast<std::size_t>(experiment.periods)});
  }
  return segments;
}

}  // namespace teleop
