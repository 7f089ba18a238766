#include "core/identification/frequency_response.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index kNeighbours = 4;  ///< to each side, of which variances are averaged

/// Spectra of one record: row = line, column = period.
struct Spectra {
  Eigen::VectorXcd R;
  Eigen::MatrixXcd U;
  Eigen::MatrixXcd Y;

  [[nodiscard]] Complex mean_U(std::size_t line) const {
    return U.row(static_cast<Eigen::Index>(line)).mean();
  }
  [[nodiscard]] Complex mean_Y(std::size_t line) const {
    return Y.row(static_cast<Eigen::Index>(line)).mean();
  }
  [[nodiscard]] double periods() const { return static_cast<double>(U.cols()); }
};

Spectra spectra(const PeriodicRecord& record, std::size_t last) {
  const Eigen::Index periods = record.force_N.cols();
  const auto rows = static_cast<Eigen::Index>(last) + 1;
  Spectra result{.R = line_spectrum(record.reference_N, last),
                 .U = Eigen::MatrixXcd{rows, periods},
                 .Y = Eigen::MatrixXcd{rows, periods}};
  for (Eigen::Index p = 0; p < periods; ++p) {
    result.U.col(p) = line_spectrum(record.force_N.col(p), last);
    result.Y.col(p) = line_spectrum(record.position_m.col(p), last);
  }
  return result;
}

/// Variance of Y − G U between the periods of one record.
double period_variance(const Spectra& s, std::size_t line, Complex gain) {
  const auto row = static_cast<Eigen::Index>(line);
  const Eigen::RowVectorXcd residual = s.Y.row(row) - gain * s.U.row(row);
  return (residual.array() - residual.mean()).abs2().sum() / (s.periods() - 1.0);
}

/// Mean over the entries at most `reach` places away.
Eigen::VectorXd smoothed(const Eigen::VectorXd& values, Eigen::Index reach) {
  Eigen::VectorXd result{values.size()};
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const Eigen::Index first = std::max<Eigen::Index>(0, i - reach);
    const Eigen::Index last = std::min(values.size() - 1, i + reach);
    result(i) = values.segment(first, last - first + 1).mean();
  }
  return result;
}

/// The gain between two excited lines: magnitude and phase on straight lines over ln f.
Complex between(const LineGrid& grid, const Eigen::VectorXcd& gain, std::size_t line) {
  const auto above = std::upper_bound(grid.excited.begin(), grid.excited.end(), line);
  const auto last = static_cast<Eigen::Index>(grid.excited.size()) - 1;
  const Eigen::Index high = std::clamp<Eigen::Index>(above - grid.excited.begin(), 1, last);
  const Complex low_gain = gain(high - 1);
  const auto at = [&](Eigen::Index i) {
    return std::log(static_cast<double>(grid.excited[static_cast<std::size_t>(i)]));
  };
  const double share =
      (std::log(static_cast<double>(line)) - at(high - 1)) / (at(high) - at(high - 1));
  return low_gain * std::pow(gain(high) / low_gain, share);
}

/// Power at lines left out, and how much of it is noise.
struct LeftOut {
  Eigen::VectorXd f_lines;  ///< which
  Eigen::VectorXd power;    ///< m², beyond noise; may come out negative
};

LeftOut left_out(const std::vector<std::size_t>& lines,
                 const LineGrid& grid,
                 const std::vector<Spectra>& records,
                 const Eigen::VectorXcd& gain) {
  const auto count = static_cast<Eigen::Index>(lines.size());
  LeftOut result{.f_lines = Eigen::VectorXd{count}, .power = Eigen::VectorXd::Zero(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t line = lines[static_cast<std::size_t>(i)];
    const Complex here = between(grid, gain, line);
    result.f_lines(i) = static_cast<double>(line);
    for (const Spectra& s : records) {
      const double noise = period_variance(s, line, here) / s.periods();
      result.power(i) += std::norm(s.mean_Y(line) - here * s.mean_U(line)) - noise;
    }
  }
  result.power /= static_cast<double>(records.size());
  return result;
}

/// Mean power of the nine lines left out that are nearest to `line`.
double power_near(const LeftOut& left_out, std::size_t line) {
  if (left_out.power.size() == 0) return 0.0;
  Eigen::Index nearest = 0;
  (left_out.f_lines.array() - static_cast<double>(line)).abs().minCoeff(&nearest);
  const Eigen::Index first = std::max<Eigen::Index>(0, nearest - kNeighbours);
  const Eigen::Index last = std::min(left_out.power.size() - 1, nearest + kNeighbours);
  return std::max(0.0, left_out.power.segment(first, last - first + 1).mean());
}

/// What the realisations say about each excited line.
struct Excited {
  Eigen::VectorXcd gain;
  Eigen::VectorXd leverage;   ///< |ΣU R*| / √Σ|R|²: RMS force a record, coherent, times √records
  Eigen::VectorXd between;    ///< variance of Y − G U between realisations
  Eigen::VectorXd in_period;  ///< and of one period within them
  Eigen::VectorXd response;   ///< mean |G U|²
};

Excited at_excited(const LineGrid& grid, const std::vector<Spectra>& records) {
  const auto count = static_cast<Eigen::Index>(grid.excited.size());
  const auto realisations = static_cast<double>(records.size());
  Excited result{.gain = Eigen::VectorXcd{count},
                 .leverage = Eigen::VectorXd{count},
                 .between = Eigen::VectorXd::Zero(count),
                 .in_period = Eigen::VectorXd::Zero(count),
                 .response = Eigen::VectorXd::Zero(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t line = grid.excited[static_cast<std::size_t>(i)];
    Complex YR = 0.0;
    Complex UR = 0.0;
    double RR = 0.0;
    for (const Spectra& s : records) {
      const Complex R = std::conj(s.R(static_cast<Eigen::Index>(line)));
      YR += s.mean_Y(line) * R;
      UR += s.mean_U(line) * R;
      RR += std::norm(R);
    }
    result.gain(i) = YR / UR;
    result.leverage(i) = std::abs(UR) / std::sqrt(RR);
    for (const Spectra& s : records) {
      const Complex U = s.mean_U(line);
      result.between(i) += std::norm(s.mean_Y(line) - result.gain(i) * U) / (realisations - 1.0);
      result.in_period(i) += period_variance(s, line, result.gain(i)) / realisations;
      result.response(i) += std::norm(result.gain(i) * U) / realisations;
    }
  }
  return result;
}

/// The most that rounding to encoder counts puts at a line of one kind: its power is count²/12.
double rounding_power(const RecordInfo& info, std::size_t samples) {
  return 2.0 * info.count_m * info.count_m / (3.0 * static_cast<double>(samples));
}

}  // namespace

MeasuredResponse measured(const FrequencyResponse& response) {
  const auto count = static_cast<Eigen::Index>(response.lines.size());
  MeasuredResponse result{.frequency_Hz = Eigen::VectorXd{count},
                          .value = Eigen::VectorXcd{count},
                          .deviation = Eigen::VectorXd{count}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const ResponseLine& line = response.lines[static_cast<std::size_t>(i)];
    result.frequency_Hz(i) = line.f_Hz;
    result.value(i) = line.gain;
    result.deviation(i) = line.deviation;
  }
  return result;
}

FrequencyResponse estimate_multisine(const LineGrid& grid,
                                     std::span<const PeriodicRecord> records,
                                     const RecordInfo& info) {
  expects(records.size() >= 2, "two realisations at least");
  const std::size_t last =
      std::max({grid.excited.back(), grid.odd_left_out.back(), grid.even_left_out.back()});
  std::vector<Spectra> all;
  for (const PeriodicRecord& record : records) {
    expects(record.force_N.cols() >= 2, "two periods at least");
    all.push_back(spectra(record, last));
  }
  const Excited excited = at_excited(grid, all);
  const Eigen::VectorXd between = smoothed(excited.between, kNeighbours);
  const Eigen::VectorXd in_period = smoothed(excited.in_period, kNeighbours);
  LeftOut odd = left_out(grid.odd_left_out, grid, all, excited.gain);
  LeftOut even = left_out(grid.even_left_out, grid, all, excited.gain);
  const double rounding = rounding_power(info, grid.samples);
  odd.power.array() -= rounding;
  even.power.array() -= rounding;

  FrequencyResponse result;
  const double resolution_Hz = info.rate_Hz / static_cast<double>(grid.samples);
  for (std::size_t i = 0; i < grid.excited.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double response = excited.response(at);
    const double odd_power = power_near(odd, grid.excited[i]);
    const double even_power = power_near(even, grid.excited[i]);
    result.lines.push_back({.f_Hz = resolution_Hz * static_cast<double>(grid.excited[i]),
                            .gain = excited.gain(at),
                            .deviation = std::sqrt(between(at)) / excited.leverage(at),
                            .coherence = response / (response + between(at) + in_period(at)),
                            .distortion = std::sqrt((odd_power + even_power) / response),
                            .odd = std::sqrt(odd_power / response),
                            .even = std::sqrt(even_power / response)});
  }
  const double spurious = odd.power.mean() + even.power.mean();
  result.distortion = std::sqrt(std::max(0.0, spurious) / excited.response.mean());
  result.distorted = result.distortion > kDistorted;
  return result;
}

ResponseLine estimate_sine(const PeriodicRecord& record,
                           std::size_t line,
                           std::span<const std::size_t> carriers,
                           const RecordInfo& info) {
  constexpr std::size_t kReach = 30;  // even, so that all are odd
  const auto samples = static_cast<std::size_t>(record.reference_N.size());
  const std::size_t last = std::min(5 * line + kReach, samples / 2 - 1);
  const Spectra s = spectra(record, last);
  const Complex R = std::conj(s.R(static_cast<Eigen::Index>(line)));
  const Complex gain = s.mean_Y(line) * R / (s.mean_U(line) * R);
  const auto residual = [&](std::size_t at) {
    return std::norm(s.mean_Y(at) - gain * s.mean_U(at));
  };
  const auto is_carrier = [&](std::size_t k) {
    return std::find(carriers.begin(), carriers.end(), k) != carriers.end();
  };
  double around = 0.0;
  double count = 0.0;
  for (std::size_t k = line > kReach ? line - kReach : line % 2; k <= line + kReach; k += 2) {
    if (k == 0 || k == line || k > last || is_carrier(k)) continue;
    around += residual(k);
    count += 1.0;
  }
  double odd = 0.0;
  double even = 0.0;
  for (std::size_t harmonic = 2; harmonic <= 5 && harmonic * line <= last; ++harmonic) {
    if (is_carrier(harmonic * line)) continue;
    const double power = std::norm(s.mean_Y(harmonic * line)) - rounding_power(info, samples);
    (harmonic % 2 == 0 ? even : odd) += std::max(0.0, power);
  }
  const double variance = std::max(around / count, period_variance(s, line, gain) / s.periods());
  const double response = std::norm(s.mean_Y(line));
  return {.f_Hz = info.rate_Hz / static_cast<double>(samples) * static_cast<double>(line),
          .gain = gain,
          .deviation = std::sqrt(variance) / std::abs(s.mean_U(line)),
          .coherence = response / (response + variance * s.periods()),
          .distortion = std::sqrt((odd + even) / response),
          .odd = std::sqrt(odd / response),
          .even = std::sqrt(even / response)};
}

}  // namespace teleop
