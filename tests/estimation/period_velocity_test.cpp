#include "core/estimation/period_velocity.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/estimation/encoder.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::WatchedEncoder;

constexpr double kPeriod = 1e-3;
constexpr double kQuantum = WatchedEncoder::kQuantum;
const JointVector kCounts = JointVector::Constant(WatchedEncoder::kCounts);

/// Largest error of the estimate while the joint moves with `speed`, after `settle_s`.
double worst_error(double speed, double duration_s, double settle_s, int samples = 16) {
  WatchedEncoder encoder;
  PeriodVelocity estimator{{.samples = samples}, kCounts};
  double worst = 0.0;
  for (int k = 1; k * kPeriod < duration_s; ++k) {
    const VelocitySample sample = encoder.read([&](double t) { return speed * t; }, k * kPeriod);
    const double error = estimator.step(sample)[0] - speed;
    if (k * kPeriod > settle_s) worst = std::max(worst, std::abs(error));
  }
  return worst;
}

TEST(PeriodVelocity, MeetsASteadySpeedWithinTheCountersResolution) {
  for (const double speed : {0.03, -0.03, 0.15, 1.0, -5.0}) {
    const double ticks = kQuantum / std::abs(speed) * 1e7;
    const double resolution = 0.6 * std::abs(speed) / ticks;
    EXPECT_LT(worst_error(speed, 0.3, 0.1), resolution) << speed;
  }
}

TEST(PeriodVelocity, IsNotDisturbedByUnevenReading) {
  WatchedEncoder encoder;
  PeriodVelocity estimator{{}, kCounts};
  Random random{12};
  const double speed = 0.4;
  double t = 0.0;
  for (int k = 0; k < 500; ++k) {
    t += kPeriod * random.uniform(0.05, 5.0);
    const double estimate = estimator.step(encoder.read([&](double s) { return speed * s; }, t))[0];
    if (k < 20) continue;
    const double ticks = kQuantum / speed * 1e7;
    EXPECT_NEAR(estimate, speed, 0.6 * speed / ticks) << k;
  }
}

TEST(PeriodVelocity, MeasuresSpeedsThatOverflowTheCounter) {
  // Δ/6.55 ms = 0.0202 rad/s; below it the loop's clock is the counter.
  for (const double speed : {0.018, 0.01, -0.005, 0.002}) {
    const double period = kQuantum / std::abs(speed);
    EXPECT_LT(worst_error(speed, 12.0 * period, 4.0 * period), std::abs(speed) * kPeriod / period)
        << speed;
  }
}

TEST(PeriodVelocity, FollowsAnArmThatStopsNoSlowerThanACountOverTheTime) {
  WatchedEncoder encoder;
  PeriodVelocity estimator{{.samples = 4}, kCounts};
  const auto motion = [](double t) {
    return 0.2 * std::min(t, 0.1);
  };
  for (int k = 1; k <= 300; ++k) {
    const double t = k * kPeriod;
    const double estimate = estimator.step(encoder.read(motion, t))[0];
    EXPECT_GE(estimate, 0.0);
    const double standing = t - 0.1 - 5.0 * kPeriod;  // oldest of the average
    if (standing > 0.0) {
      EXPECT_LE(estimate, kQuantum / standing) << t;
    }
    if (t > 0.1 + 0.1 + 6.0 * kPeriod) {
      EXPECT_EQ(estimate, 0.0) << t;
    }
  }
}

TEST(PeriodVelocity, HasNoSpeedFromOneLineCrossedThereAndBack) {
  // Turns right behind a line: both last edges are that line, a moment apart.
  PeriodVelocity estimator{{.samples = 1}, kCounts};
  const auto at = [](double counts, std::int32_t ticks) {
    return VelocitySample{.q = JointVector::Constant(counts * kQuantum),
                          .period_ticks = {ticks, ticks, ticks},
                          .dt = kPeriod};
  };
  estimator.step(at(0.0, 0));
  EXPECT_NEAR(estimator.step(at(1.0, 20'000))[0], kQuantum / 2e-3, 1e-9);
  EXPECT_EQ(estimator.step(at(0.0, -50))[0], 0.0);
  EXPECT_NEAR(estimator.step(at(-1.0, -10'000))[0], -kQuantum / 1e-3, 1e-9);
  EXPECT_EQ(estimator.step(at(-1.0, -40))[0], 0.0) << "there and back within one update";
  EXPECT_NEAR(estimator.step(at(2.0, 4000))[0], kQuantum / 0.4e-3, 1e-9)
      << "two edges of the new direction are a period";
}

TEST(PeriodVelocity, FollowsAnOscillationThroughItsTurns) {
  WatchedEncoder encoder;
  PeriodVelocity estimator{{.samples = 1}, kCounts};
  constexpr double kOmega = 2.0 * std::numbers::pi * 5.0;
  constexpr double kAmplitude = 0.02;  // 150 counts
  double worst = 0.0;
  for (int k = 1; k <= 1000; ++k) {
    const double t = k * kPeriod;
    const auto motion = [](double s) {
      return kAmplitude * std::sin(kOmega * s);
    };
    const double estimate = estimator.step(encoder.read(motion, t))[0];
    if (k > 20)
      worst = std::max(worst, std::abs(estimate - kAmplitude * kOmega * std::cos(kOmega * t)));
  }
  // One period of edges late: √(2 Δ a) at a turn with acceleration a, and an update.
  const double a = kAmplitude * kOmega * kOmega;
  EXPECT_LT(worst, std::sqrt(2.0 * kQuantum * a) + a * kPeriod);
}

TEST(PeriodVelocity, DoesNotSeeUnequalQuadratureWhenItAveragesFourEdges) {
  const auto ripple = [](int samples) {
    WatchedEncoder encoder;
    encoder.spacing = {0.0, 0.08, -0.05, 0.03};
    PeriodVelocity estimator{{.samples = samples}, kCounts};
    const double speed = kQuantum / kPeriod;  // an edge an update
    double low = 1e9;
    double high = 0.0;
    for (int k = 1; k <= 200; ++k) {
      const auto motion = [&](double t) {
        return speed * (t + 0.3e-3);
      };
      const double estimate = estimator.step(encoder.read(motion, k * kPeriod))[0];
      if (k < 50) continue;
      low = std::min(low, estimate);
      high = std::max(high, estimate);
    }
    return (high - low) / speed;
  };
  EXPECT_GT(ripple(1), 0.1);
  EXPECT_LT(ripple(4), 1e-3);
  EXPECT_LT(ripple(16), 1e-3);
}

TEST(PeriodVelocity, LagsAConstantAccelerationByHalfItsAverageAndAPeriodOfEdges) {
  WatchedEncoder encoder;
  PeriodVelocity estimator{{}, kCounts};
  constexpr double kAcceleration = 5.0;
  double sum = 0.0;
  int n = 0;
  for (int k = 1; k <= 400; ++k) {
    const double t = k * kPeriod;
    const auto motion = [](double s) {
      return 0.5 * kAcceleration * s * s;
    };
    const double estimate = estimator.step(encoder.read(motion, t))[0];
    if (k <= 200) continue;
    const double edges = kQuantum / (kAcceleration * (t - 7.5 * kPeriod));
    sum += (t - estimate / kAcceleration) - (7.5 * kPeriod + edges);
    ++n;
  }
  EXPECT_NEAR(sum / n, 0.0, 0.02e-3);
}

TEST(PeriodVelocity, SeesAnArmWithoutCounterThroughItsCounts) {
  PeriodVelocity estimator{{.samples = 16}, kCounts};
  const double speed = 1.7;
  Random random{11};
  double t = 0.0;
  double estimate = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double dt = kPeriod * random.uniform(0.5, 1.5);
    t += dt;
    const double counts = std::round(speed * t / kQuantum);
    estimate = estimator.step({.q = JointVector::Constant(counts * kQuantum), .dt = dt})[2];
  }
  EXPECT_NEAR(estimate, speed, 2.0 * kQuantum / (16.0 * kPeriod));
}

TEST(PeriodVelocity, FirstSampleAndTheFirstAfterResetGiveZero) {
  PeriodVelocity estimator{{}, kCounts};
  const VelocitySample sample{
      .q = JointVector::Ones(), .period_ticks = {300, 300, 300}, .dt = kPeriod};
  EXPECT_EQ(estimator.step(sample).norm(), 0.0);
  estimator.step(
      {.q = JointVector::Constant(1.01), .period_ticks = {200, 200, 200}, .dt = kPeriod});
  estimator.reset();
  EXPECT_EQ(estimator.step(sample).norm(), 0.0);
  EXPECT_EQ(estimator.step(sample).norm(), 0.0);
}

TEST(PeriodVelocity, KeepsItsEstimateWhenNoTimePassed) {
  PeriodVelocity estimator{{}, kCounts};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  const VelocitySample moved{
      .q = JointVector::Ones(), .period_ticks = {200, 200, 200}, .dt = kPeriod};
  const JointVector before = estimator.step(moved);
  EXPECT_EQ(estimator.step({.q = JointVector::Zero(), .dt = 0.0}), before);
}

TEST(PeriodVelocity, RejectsAveragesThatDoNotCancelTheQuadratureAndArmsWithoutCounts) {
  for (const int samples : {0, 2, 15, 18, PeriodVelocity::kMostSamples + 4}) {
    EXPECT_THROW((PeriodVelocity{{.samples = samples}, kCounts}), ConfigError) << samples;
  }
  EXPECT_THROW((PeriodVelocity{{.standstill_ms = 0.0}, kCounts}), ConfigError);
  EXPECT_THROW((PeriodVelocity{{}, JointVector::Zero()}), ConfigError);
}

TEST(PeriodVelocity, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  PeriodVelocity estimator{{}, kCounts};
  const testing::NoAllocation guard;
  for (int k = 0; k < 40; ++k) {
    estimator.step({.q = JointVector::Constant(k * kQuantum),
                    .period_ticks = {9000, -9000, 0},
                    .dt = kPeriod});
  }
  estimator.reset();
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
