#include "core/identification/multisine.hpp"

#include <unsupported/Eigen/FFT>

#include "core/base/contract.hpp"

namespace teleop {

LineGrid odd_random_grid(std::size_t samples, std::size_t first, std::size_t last, Random& random) {
  expects(first < last && 2 * last < samples, "lines below half the rate");
  LineGrid grid{.samples = samples};
  std::size_t silent = random.bits() % 3;
  std::size_t in_group = 0;
  for (std::size_t line = first; line <= last; ++line) {
    if (line % 2 == 0) {
      if (line > 0) grid.even_left_out.push_back(line);
      continue;
    }
    (in_group == silent ? grid.odd_left_out : grid.excited).push_back(line);
    if (++in_group == 3) {
      in_group = 0;
      silent = random.bits() % 3;
    }
  }
  return grid;
}

Eigen::VectorXd periodic_signal(std::size_t samples,
                                std::span<const std::size_t> lines,
                                std::span<const std::complex<double>> amplitudes) {
  expects(lines.size() == amplitudes.size(), "an amplitude a line");
  Eigen::VectorXcd spectrum = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(samples));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    expects(lines[i] < samples, "a line of the period");
    spectrum(static_cast<Eigen::Index>(lines[i])) += amplitudes[i] * static_cast<double>(samples);
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd signal;
  fft.inv(signal, spectrum);
  return signal.real();
}

Eigen::VectorXcd line_spectrum(const Eigen::VectorXd& period, std::size_t last) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXcd spectrum;
  fft.fwd(spectrum, period);
  return spectrum.head(static_cast<Eigen::Index>(last) + 1) *
         (2.0 / static_cast<double>(period.size()));
}

}  // namespace teleop
