#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/identification/frequency_response.hpp"
#include "core/identification/multisine.hpp"
#include "core/identification/periodic_drive.hpp"
#include "core/math/random.hpp"

namespace teleop {

enum class Excitation : std::uint8_t { multisine, stepped_sine };

/// What to measure, and how far the arm may go for it.
struct ResponseExperiment {
  std::size_t axis = 0;  ///< 0 to 2: x, y, z
  Excitation excitation = Excitation::multisine;
  double rate_Hz = 10000.0;
  double low_Hz = 3.0;
  double high_Hz = 500.0;
  double period_s = 1.0;     ///< the resolution is its inverse
  int periods = 3;           ///< kept of every realisation or line
  int realisations = 12;     ///< of the multisine, with other phases each
  int lines = 40;            ///< of the stepped sine
  double max_force_N = 5.0;  ///< commanded, holding loop included
  double max_travel_m = 0.005;
  double gravity_share = 0.0;  ///< of the model's weight that is carried beside the response
  std::uint64_t seed = 1;      ///< of lines and phases
};

/// Lines are multiples of 1/period; those of the multisine, of which a stepped sine takes some.
[[nodiscard]] LineGrid grid_of(const ResponseExperiment& experiment, Random& random);

/// Periods played before those that are kept: until the holding loop has forgotten the start.
[[nodiscard]] std::size_t settle_periods(const ResponseExperiment& experiment);

/// Amplitudes of position and of force for a unit of reference, at each excited line.
struct Answer {
  Eigen::VectorXd position_m;
  Eigen::VectorXd force_N;
};
[[nodiscard]] Answer answer_of(const LineGrid& grid, const PeriodicRecord& record);

/// How a free tool of 20 g answers: lighter than any arm, so the pilot spares the travel.
[[nodiscard]] Answer answer_of_lightest(const LineGrid& grid, double period_s);

/// How much of a multisine.
struct Effort {
  int realisations = 1;
  int periods = 2;
  double share = 1.0;  ///< of what the limits allow
};

/// Multisines of random phases, another draw each. Line amplitudes are min(A_f/|force|,
/// A_y/|position|) with A_f and A_y as large as force and travel bear for every realisation.
[[nodiscard]] std::vector<PeriodicDrive::Segment> multisine_segments(
    const ResponseExperiment& experiment,
    const LineGrid& grid,
    const Answer& answer,
    const Effort& effort,
    Random& random);

/// Indices into grid.excited, about evenly spaced over ln f.
[[nodiscard]] std::vector<std::size_t> stepped_lines(const ResponseExperiment& experiment,
                                                     const LineGrid& grid);

/// The slow lines that go with every sine: alone it is rounded alike in every turn, and a small one
/// not seen at all; with them rounding acts like noise.
[[nodiscard]] std::span<const std::size_t> carriers_of(const LineGrid& grid);

/// A sine a line, as large as force and travel bear.
[[nodiscard]] std::vector<PeriodicDrive::Segment> stepped_segments(
    const ResponseExperiment& experiment,
    const LineGrid& grid,
    const Answer& answer,
    double count_m,
    Random& random);

}  // namespace teleop
