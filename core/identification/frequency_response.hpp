#pragma once

#include <complex>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/identification/multisine.hpp"
#include "core/identification/response_fit.hpp"

namespace teleop {

/// Whole periods of an experiment in its steady state, a column each.
struct PeriodicRecord {
  Eigen::VectorXd reference_N;  ///< one period of what was added to the holding loop
  Eigen::MatrixXd force_N;      ///< commanded: reference and holding loop, exactly known
  Eigen::MatrixXd position_m;   ///< read just before the command of the same row was written
};

/// One line of a frequency response.
struct ResponseLine {
  double f_Hz = 0.0;
  std::complex<double> gain;  ///< m/N, of the samples
  double deviation = 0.0;     ///< √E|error|² of the gain, m/N
  double coherence = 0.0;   ///< 0 to 1: share of the response of one period that the force explains
  double distortion = 0.0;  ///< of the response at this line, by what appears at lines left out
  double odd = 0.0;         ///< its part at odd lines
  double even = 0.0;        ///< its part at even lines
};

struct FrequencyResponse {
  std::vector<ResponseLine> lines;
  double distortion = 0.0;  ///< RMS of what appears at lines left out, over RMS of the response
  bool distorted = false;   ///< beyond kDistorted: the arm is not linear at this amplitude
};

inline constexpr double kDistorted = 0.005;

/// How the records were taken.
struct RecordInfo {
  double rate_Hz = 0.0;
  double count_m = 0.0;  ///< one encoder count along the axis
};

[[nodiscard]] MeasuredResponse measured(const FrequencyResponse& response);

/// The best linear approximation from several realisations of a multisine with other phases each
/// [Pintelon 2012, sections 4.3 and 2.7]. Position and force of a line are averaged against the
/// reference, so noise that the holding loop feeds back does not bend the ratio:
///
///     G = Σ_m Y_m R_m* / Σ_m U_m R_m*
///
/// Its variance comes from how Y − G U differs between realisations, averaged over nine
/// neighbouring lines. That holds what differs between periods (noise) and what repeats in every
/// period but not with other phases: rounding to encoder counts and nonlinear distortion.
/// @pre two records of two periods each at least.
[[nodiscard]] FrequencyResponse estimate_multisine(const LineGrid& grid,
                                                   std::span<const PeriodicRecord> records,
                                                   const RecordInfo& info);

/// One line from a sine, beside which `carriers`, slow lines, may move the encoder over its counts.
/// The variance comes from what stands at the odd lines around it, where rounding of a signal of
/// odd lines goes; distortion from the harmonics 2 to 5.
[[nodiscard]] ResponseLine estimate_sine(const PeriodicRecord& record,
                                         std::size_t line,
                                         std::span<const std::size_t> carriers,
                                         const RecordInfo& info);

}  // namespace teleop
