#include "core/estimation/difference_velocity.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

double alpha(double cutoff_Hz) {
  return 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff_Hz * kPeriod);
}

TEST(DifferenceVelocity, FirstSampleGivesZeroWhereverTheArmStands) {
  DifferenceVelocity estimator{{}};
  EXPECT_EQ(estimator.step({.q = {1.0, -2.0, 3.0}, .dt = kPeriod}).norm(), 0.0);
}

TEST(DifferenceVelocity, MeetsASteadySpeedExactlyUnderJitter) {
  DifferenceVelocity estimator{{.cutoff_Hz = 100.0}};
  const JointVector speed{0.3, -2.0, 7.0};
  Random random{1};
  double t = 0.0;
  estimator.step({.q = speed * t, .dt = kPeriod});
  for (int k = 0; k < 500; ++k) {
    const double dt = kPeriod * random.uniform(0.2, 3.0);
    t += dt;
    estimator.step({.q = speed * t, .dt = dt});
  }
  EXPECT_NEAR((estimator.state().qd - speed).norm(), 0.0, 1e-9);
}

TEST(DifferenceVelocity, LagsAConstantAccelerationAsStated) {
  for (const double cutoff_Hz : {20.0, 100.0, 300.0}) {
    DifferenceVelocity estimator{{.cutoff_Hz = cutoff_Hz}};
    double t = 0.0;
    for (int k = 0; k <= 2000; ++k) {
      t = k * kPeriod;
      estimator.step({.q = JointVector::Constant(0.5 * t * t), .dt = kPeriod});  // 1 rad/s²
    }
    const double a = alpha(cutoff_Hz);
    const double lag = kPeriod / 2.0 + kPeriod * (1.0 - a) / a;
    EXPECT_NEAR(t - estimator.state().qd[0], lag, 1e-9) << cutoff_Hz << " Hz";
  }
}

TEST(DifferenceVelocity, PassesWhiteNoiseWithTheStatedGain) {
  constexpr int kSamples = 200'000;
  DifferenceVelocity estimator{{.cutoff_Hz = 100.0}};
  Random random{7};
  double power = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const JointVector noise{1e-4 * random.normal(), 0.0, 0.0};
    power += std::pow(estimator.step({.q = noise, .dt = kPeriod})[0], 2);
  }
  const double a = alpha(100.0);
  const double stated = 1e-4 / kPeriod * std::sqrt(2.0 * a * a / (2.0 - a));
  EXPECT_NEAR(std::sqrt(power / kSamples) / stated, 1.0, 0.02);
}

TEST(DifferenceVelocity, WithoutCutoffIsThePureDifferenceOf30MillimetresPerSecondACount) {
  DifferenceVelocity estimator{{.cutoff_Hz = 0.0}};
  const JointVector count = JointVector::Constant(30e-6);  // m, as the paper counts
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  EXPECT_NEAR(estimator.step({.q = count, .dt = kPeriod})[0], 0.030, 1e-12);
  EXPECT_EQ(estimator.step({.q = count, .dt = kPeriod})[0], 0.0);
}

TEST(DifferenceVelocity, StartsAnewAfterReset) {
  DifferenceVelocity estimator{{}};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  estimator.step({.q = JointVector::Ones(), .dt = kPeriod});
  estimator.reset();
  EXPECT_EQ(estimator.step({.q = {5.0, 5.0, 5.0}, .dt = kPeriod}).norm(), 0.0);
}

TEST(DifferenceVelocity, KeepsItsEstimateWhenNoTimePassed) {
  DifferenceVelocity estimator{{}};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  const JointVector before = estimator.step({.q = JointVector::Ones() * 1e-3, .dt = kPeriod});
  EXPECT_EQ(estimator.step({.q = JointVector::Ones() * 2e-3, .dt = 0.0}), before);
}

TEST(DifferenceVelocity, RejectsACutoffThatIsNegative) {
  EXPECT_THROW((DifferenceVelocity{{.cutoff_Hz = -1.0}}), ConfigError);
  EXPECT_THROW((DifferenceVelocity{{.cutoff_Hz = std::numeric_limits<double>::quiet_NaN()}}),
               ConfigError);
}

TEST(DifferenceVelocity, TakesItsCutoffFromSettings) {
  DifferenceVelocity::Config config;
  Settings settings;
  add_settings(settings, "velocity.", config);
  settings.load_text("[velocity]\ncutoff_Hz = 50\n", "side.toml");
  EXPECT_EQ(config.cutoff_Hz, 50.0);
  EXPECT_THROW(settings.set("velocity.cutoff_Hz", "-1", "command line"), ConfigError);
}

TEST(DifferenceVelocity, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  DifferenceVelocity estimator{{}};
  const testing::NoAllocation guard;
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  estimator.step({.q = JointVector::Ones(), .dt = kPeriod});
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
