#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/math/random.hpp"

namespace teleop {

/// Which lines of a periodic signal are driven, as multiples of 1/period. Of the odd ones a random
/// one in three stays silent, the even ones all do: what an odd or an even nonlinearity makes of
/// the signal shows at those that were left out [Pintelon 2012, section 4.3.1].
struct LineGrid {
  std::size_t samples = 0;  ///< of one period
  std::vector<std::size_t> excited{};
  std::vector<std::size_t> odd_left_out{};
  std::vector<std::size_t> even_left_out{};
};

/// @pre first < last < samples/2.
[[nodiscard]] LineGrid odd_random_grid(std::size_t samples,
                                       std::size_t first,
                                       std::size_t last,
                                       Random& random);

/// One period of Σ Re{A_k exp(j 2π k n / samples)}.
[[nodiscard]] Eigen::VectorXd periodic_signal(std::size_t samples,
                                              std::span<const std::size_t> lines,
                                              std::span<const std::complex<double>> amplitudes);

/// The amplitudes A_k of lines 0 to last of one period, such that a sine of amplitude A has |A_k| =
/// A.
[[nodiscard]] Eigen::VectorXcd line_spectrum(const Eigen::VectorXd& period, std::size_t last);

}  // namespace teleop
