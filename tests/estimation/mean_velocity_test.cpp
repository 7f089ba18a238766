#include "core/estimation/mean_velocity.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

TEST(MeanVelocity, OfAHundredLagsAConstantAccelerationBy50Milliseconds) {
  MeanVelocity estimator{{}};
  JointVector estimate;
  double t = 0.0;
  for (int k = 0; k <= 500; ++k) {
    t = k * kPeriod;
    estimate = estimator.step({.q = JointVector::Constant(0.5 * t * t), .dt = kPeriod});
  }
  EXPECT_NEAR(t - estimate[0], 0.0495 + 0.0005, 1e-9);  // of the average and of the difference
}

TEST(MeanVelocity, MeetsASteadySpeedExactlyUnderJitterFromTheSecondSampleOn) {
  MeanVelocity estimator{{.samples = 7}};
  const JointVector speed{0.3, -2.0, 7.0};
  Random random{3};
  double t = 0.0;
  EXPECT_EQ(estimator.step({.q = speed * t, .dt = kPeriod}).norm(), 0.0);
  for (int k = 0; k < 300; ++k) {
    const double dt = kPeriod * random.uniform(0.01, 5.0);
    t += dt;
    EXPECT_NEAR((estimator.step({.q = speed * t, .dt = dt}) - speed).norm(), 0.0, 1e-8) << k;
  }
}

TEST(MeanVelocity, IsTheMeanOfTheFirstDifferencesOfEvenSamples) {
  constexpr int kSamples = 12;
  MeanVelocity estimator{{.samples = kSamples}};
  Random random{4};
  std::vector<double> q;
  for (int k = 0; k < 60; ++k) {
    q.push_back(random.normal());
    const double estimate =
        estimator.step({.q = JointVector::Constant(q.back()), .dt = kPeriod})[1];
    if (k < kSamples) continue;
    double mean = 0.0;
    for (std::size_t i = q.size() - kSamples; i < q.size(); ++i) {
      mean += (q[i] - q[i - 1]) / kPeriod / kSamples;
    }
    EXPECT_NEAR(estimate, mean, 1e-9) << k;
  }
}

TEST(MeanVelocity, PassesWhiteNoiseWithTheStatedGain) {
  constexpr int kSamples = 200'000;
  MeanVelocity estimator{{.samples = 20}};
  Random random{9};
  double power = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const JointVector noise{1e-4 * random.normal(), 0.0, 0.0};
    power += std::pow(estimator.step({.q = noise, .dt = kPeriod})[0], 2);
  }
  const double stated = std::sqrt(2.0) * 1e-4 / (20 * kPeriod);
  EXPECT_NEAR(std::sqrt(power / kSamples) / stated, 1.0, 0.02);
}

TEST(MeanVelocity, StartsAnewAfterReset) {
  MeanVelocity estimator{{.samples = 5}};
  for (int k = 0; k < 9; ++k) {
    estimator.step({.q = JointVector::Constant(k), .dt = kPeriod});
  }
  estimator.reset();
  const JointVector there = JointVector::Constant(-4.0);
  EXPECT_EQ(estimator.step({.q = there, .dt = kPeriod}).norm(), 0.0);
  EXPECT_EQ(estimator.step({.q = there, .dt = kPeriod}).norm(), 0.0);
}

TEST(MeanVelocity, KeepsItsEstimateWhenNoTimePassed) {
  MeanVelocity estimator{{}};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  const JointVector before = estimator.step({.q = JointVector::Ones(), .dt = kPeriod});
  EXPECT_EQ(estimator.step({.q = JointVector::Ones() * 3.0, .dt = 0.0}), before);
}

TEST(MeanVelocity, RejectsAnEmptyAverage) {
  EXPECT_THROW(MeanVelocity{{.samples = 0}}, ConfigError);
  EXPECT_THROW(MeanVelocity{{.samples = MeanVelocity::kMostSamples + 1}}, ConfigError);
}

TEST(MeanVelocity, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  MeanVelocity estimator{{.samples = 4}};
  const testing::NoAllocation guard;
  for (int k = 0; k < 20; ++k) {
    estimator.step({.q = JointVector::Constant(k), .dt = kPeriod});
  }
  estimator.reset();
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
