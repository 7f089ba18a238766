#include "core/tuning/modes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Dense>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

constexpr Eigen::Index kMostRows = 100;

/// H Hᵀ of the Hankel matrix H(i, k) = y[i + k]; each diagonal follows from its first entry.
Eigen::MatrixXd hankel_gram(std::span<const double> y, Eigen::Index rows) {
  const auto at = [&](Eigen::Index i) {
    return y[static_cast<std::size_t>(i)];
  };
  const Eigen::Index columns = static_cast<Eigen::Index>(y.size()) - rows + 1;
  Eigen::MatrixXd R(rows, rows);
  for (Eigen::Index lag = 0; lag < rows; ++lag) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < columns; ++k) {
      sum += at(k) * at(k + lag);
    }
    for (Eigen::Index i = 0; i + lag < rows; ++i) {
      R(i, i + lag) = sum;
      R(i + lag, i) = sum;
      if (i + lag + 1 < rows) sum += at(i + columns) * at(i + lag + columns) - at(i) * at(i + lag);
    }
  }
  return R;
}

}  // namespace

std::vector<FreeMode> find_modes(std::span<const double> y, double dt_s, double noise_std) {
  expects(dt_s > 0.0 && y.size() >= 8, "modes: a record and its sample time");
  const auto size = static_cast<Eigen::Index>(y.size());
  const Eigen::Index rows = std::min(size / 2, kMostRows);
  const auto columns = static_cast<double>(size - rows + 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{hankel_gram(y, rows)};

  // White noise alone would reach σ² (√rows + √columns)² [Marchenko–Pastur].
  const double edge = std::pow(std::sqrt(static_cast<double>(rows)) + std::sqrt(columns), 2);
  const double strongest = solver.eigenvalues()[rows - 1];
  const double threshold = std::max(2.0 * noise_std * noise_std * edge, 1e-13 * strongest);
  Eigen::Index poles = 0;
  while (poles < std::min<Eigen::Index>(kMostPoles, rows / 2) &&
         solver.eigenvalues()[rows - 1 - poles] > threshold) {
    ++poles;
  }
  if (poles == 0) return {};
  const Eigen::MatrixXd U = solver.eigenvectors().rightCols(poles);
  const Eigen::MatrixXd shift =
      U.topRows(rows - 1).colPivHouseholderQr().solve(U.bottomRows(rows - 1));

  std::vector<FreeMode> modes;
  for (const std::complex<double>& z : shift.eigenvalues()) {
    const bool mirrored = z.imag() < 0.0;
    if (mirrored || std::abs(z) < 1e-3) continue;
    modes.push_back(
        {.growth_per_s = std::log(std::abs(z)) / dt_s, .omega_rad_per_s = std::arg(z) / dt_s});
  }
  std::sort(modes.begin(), modes.end(),
            [](const FreeMode& a, const FreeMode& b) { return a.growth_per_s > b.growth_per_s; });
  return modes;
}

}  // namespace teleop
