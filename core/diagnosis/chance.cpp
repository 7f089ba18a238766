#include "core/diagnosis/chance.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/math/random.hpp"

namespace teleop {

double chance_of(double largest, const Pulls& pulls, std::uint64_t seed) {
  constexpr int kSamples = 1000;
  constexpr std::size_t kTail = 100;  // of the samples, whose excess gives the tail
  Random random{seed};
  std::vector<double> maxima;
  maxima.reserve(kSamples);
  Eigen::RowVectorXd signs{pulls.by_stretch.rows()};
  for (int sample = 0; sample < kSamples; ++sample) {
    for (double& sign : signs) {
      sign = (random.bits() & 1U) != 0U ? 1.0 : -1.0;
    }
    const Eigen::RowVectorXd sums = signs * pulls.by_stretch;
    maxima.push_back((sums.array().square() / pulls.weight.transpose().array()).maxCoeff());
  }
  std::sort(maxima.begin(), maxima.end(), std::greater<>{});
  const double start = maxima[kTail];
  if (largest <= start) {
    const auto above =
        std::count_if(maxima.begin(), maxima.end(), [&](double each) { return each >= largest; });
    return (static_cast<double>(above) + 0.5) / (kSamples + 1.0);
  }
  double excess = 0.0;
  for (std::size_t i = 0; i < kTail; ++i) {
    excess += (maxima[i] - start) / static_cast<double>(kTail);
  }
  const double share = static_cast<double>(kTail) / kSamples;
  return share * std::exp(-(largest - start) / std::max(excess, 1e-12));
}

}  // namespace teleop
