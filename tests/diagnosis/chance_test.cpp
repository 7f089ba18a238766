#include "core/diagnosis/chance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/diagnosis/replicate.hpp"
#include "core/diagnosis/self_check.hpp"
#include "core/math/random.hpp"
#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

constexpr Eigen::Index kStretches = 200;
constexpr Eigen::Index kQuantities = 20;

/// Pulls of noise; quantities overlap with their neighbours.
Pulls noise(std::uint64_t seed) {
  Random random{seed};
  Pulls pulls{.by_stretch = Eigen::MatrixXd::Zero(kStretches, kQuantities),
              .weight = Eigen::VectorXd::Constant(kQuantities, 2.0 * kStretches)};
  for (Eigen::Index i = 0; i < kStretches; ++i) {
    double last = random.normal();
    for (Eigen::Index j = 0; j < kQuantities; ++j) {
      const double own = random.normal();
      pulls.by_stretch(i, j) = own + last;
      last = own;
    }
  }
  return pulls;
}

double largest(const Pulls& pulls) {
  return (pulls.by_stretch.colwise().sum().array().square() / pulls.weight.transpose().array())
      .maxCoeff();
}

/// Kolmogorov's distance from the uniform distribution.
double distance_from_uniform(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, values[i] - below / n, (below + 1.0) / n - values[i]});
  }
  return distance;
}

TEST(Chance, IsUniformWhereNothingIsLeft) {
  constexpr std::size_t kCases = 200;
  std::vector<double> chances;
  for (std::uint64_t seed = 0; seed < kCases; ++seed) {
    const Pulls pulls = noise(seed);
    chances.push_back(chance_of(largest(pulls), pulls, 1));
  }
  // 1.63 / √n: exceeded by one sample of uniform values in a hundred.
  EXPECT_LT(distance_from_uniform(chances), 1.63 / std::sqrt(kCases));
}

TEST(Chance, IsSmallForARegularity) {
  Pulls pulls = noise(3);
  pulls.by_stretch.col(7).array() += 1.0;
  EXPECT_LT(chance_of(largest(pulls), pulls, 1), 1e-6);
}

TEST(Chance, FallsWithTheGainBeyondWhatResamplingShows) {
  const Pulls pulls = noise(5);
  EXPECT_LT(chance_of(80.0, pulls, 1), chance_of(40.0, pulls, 1));
  EXPECT_GT(chance_of(40.0, pulls, 1), 0.0);
}

TEST(Replica, IsAsProbableUnderItsModelAsItShouldBe) {
  const std::vector<EffectSpec> effects{
      {.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.005}}}};
  const DiagnosisCase data = testing::make_case({.effects = effects, .seed = 5});
  Likelihood likelihood{data, testing::phantom(), 1};
  NoiseModel noise;
  noise.reading = data.resolution / std::sqrt(12.0);
  likelihood.set_noise(noise);
  const DiagnosisCase made = replicate(likelihood, {.effects = effects}, noise, 1);
  Likelihood other{made, testing::phantom(), 1};
  other.set_noise(noise);
  double power = 0.0;
  double count = 0.0;
  for (const Eigen::VectorXf& errors : other.errors({.effects = effects})) {
    power += static_cast<double>(errors.squaredNorm());
    count += static_cast<double>(errors.size());
  }
  EXPECT_NEAR(power / count, 1.0, 0.05);
  EXPECT_NE(made.runs[0].q[100], data.runs[0].q[100]);
  // The weak law keeps it near the recorded motion.
  for (std::size_t k = 0; k < data.runs[0].rows(); ++k) {
    ASSERT_LT((made.runs[0].q[k] - data.runs[0].q[k]).cwiseAbs().maxCoeff(), 0.1) << k;
  }
}

}  // namespace
}  // namespace teleop
