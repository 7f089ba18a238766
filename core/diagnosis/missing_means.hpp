#pragma once

#include <cstddef>
#include <vector>

#include "core/diagnosis/localisation.hpp"

namespace teleop {

/// A value that falls into a cell in a block of time.
struct CellSample {
  std::size_t cell = 0;
  std::size_t block = 0;
  double value = 0.0;
};

/// Mean of each cell and how sure it is: whole blocks of time are drawn anew, since neighbouring
/// rows are not independent. The same samples give the same bits.
[[nodiscard]] std::vector<MissingMean> block_means(const std::vector<CellSample>& samples,
                                                   std::size_t cells,
                                                   std::size_t blocks);

/// Edges of bins of equal counts, one less than there are bins.
[[nodiscard]] std::vector<double> even_edges(std::vector<double> values, std::size_t bins);

/// Welch's spectrum of unit-variance noise is 1 at every frequency.
[[nodiscard]] std::vector<double> whitened_spectrum(const std::vector<std::vector<double>>& runs,
                                                    double period_s,
                                                    const std::vector<double>& f_Hz);

}  // namespace teleop
