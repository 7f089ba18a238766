#include "core/estimation/velocity_estimator.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;
const JointVector kCounts{54476.8, 47513.6, 47513.6};

VelocityEstimator named(std::string_view kind) {
  return VelocityEstimator{{.kind = std::string{kind}}, kCounts};
}

TEST(VelocityEstimator, ByDefaultIsTheDifferenceBitForBit) {
  VelocityEstimator chosen{{}, kCounts};
  DifferenceVelocity difference{{}};
  Random random{5};
  for (int k = 0; k < 500; ++k) {
    const VelocitySample sample{.q = {random.normal(), random.normal(), random.normal()},
                                .dt = kPeriod * random.uniform(0.5, 2.0)};
    ASSERT_EQ(chosen.step(sample), difference.step(sample)) << k;
  }
  EXPECT_EQ(velocity_kinds().front(), VelocityEstimator::Config{}.kind);
}

TEST(VelocityEstimator, OfEveryKindStartsFromZeroAndStartsAnewAfterReset) {
  for (const std::string_view kind : velocity_kinds()) {
    VelocityEstimator estimator = named(kind);
    VelocityEstimator fresh = named(kind);
    const VelocitySample first{.q = {0.1, -0.2, 0.3}, .dt = kPeriod};
    EXPECT_EQ(estimator.step(first).norm(), 0.0) << kind;
    for (int k = 0; k < 50; ++k) {
      estimator.step({.q = JointVector::Constant(0.01 * k), .dt = kPeriod});
    }
    estimator.reset();
    Random random{6};
    for (int k = 0; k < 50; ++k) {
      const VelocitySample sample{.q = JointVector::Constant(1e-3 * random.normal()),
                                  .dt = kPeriod};
      ASSERT_EQ(estimator.step(sample), fresh.step(sample)) << kind << k;
    }
  }
}

TEST(VelocityEstimator, OfEveryKindKeepsItsEstimateWhenNoTimePassed) {
  for (const std::string_view kind : velocity_kinds()) {
    VelocityEstimator estimator = named(kind);
    JointVector before;
    for (int k = 0; k < 30; ++k) {
      before = estimator.step({.q = JointVector::Constant(0.01 * k), .dt = kPeriod});
    }
    EXPECT_EQ(estimator.step({.q = JointVector::Ones(), .dt = 0.0}), before) << kind;
    EXPECT_EQ(estimator.step({.q = JointVector::Ones(), .dt = -1.0}), before) << kind;
  }
}

TEST(VelocityEstimator, OfEveryKindStepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  for (const std::string_view kind : velocity_kinds()) {
    VelocityEstimator estimator = named(kind);
    const testing::NoAllocation guard;
    for (int k = 0; k < 300; ++k) {
      estimator.step({.q = JointVector::Constant(1e-4 * k * k), .dt = kPeriod});
    }
    estimator.reset();
    EXPECT_EQ(guard.count(), 0U) << kind;
  }
}

TEST(VelocityEstimator, IsChosenBySettings) {
  VelocityEstimator::Config config;
  Settings settings;
  add_settings(settings, "velocity.", config);
  settings.load_text("[velocity]\nkind = \"period\"\ncutoff_Hz = 50\nperiod.samples = 8\n",
                     "side.toml");
  EXPECT_EQ(config.kind, "period");
  EXPECT_EQ(config.difference.cutoff_Hz, 50.0);
  EXPECT_EQ(config.period.samples, 8);
  EXPECT_NO_THROW((VelocityEstimator{config, kCounts}));
}

TEST(VelocityEstimator, NamesTheKindsThereAreWhenThereIsNoSuchKind) {
  try {
    (void)named("guess");
    FAIL() << "took it";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'guess'"), std::string::npos);
    for (const std::string_view kind : velocity_kinds()) {
      EXPECT_NE(text.find(kind), std::string::npos) << kind;
    }
  }
}

}  // namespace
}  // namespace teleop
