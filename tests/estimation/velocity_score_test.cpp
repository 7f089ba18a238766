#include "core/estimation/velocity_score.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

/// A joint on a circle of 0.2 m that swings at 1 and 2.7 Hz, read exactly or in counts.
VelocityTrace swing(double counts_per_rev, double amplitude = 0.1, bool rounded = false) {
  VelocityTrace trace{.source = "test", .counts_per_rev = JointVector::Constant(counts_per_rev)};
  const double quantum = 2.0 * std::numbers::pi / counts_per_rev;
  for (int k = 0; k < 4000; ++k) {
    const double t = k * kPeriod;
    double q = amplitude * (std::sin(6.3 * t) + 0.3 * std::sin(17.0 * t));
    if (rounded) q = quantum * std::round(q / quantum);
    const double qd = amplitude * (6.3 * std::cos(6.3 * t) + 0.3 * 17.0 * std::cos(17.0 * t));
    trace.samples.push_back({.q = JointVector{q, 0.0, 0.0}, .dt = kPeriod});
    trace.time_s.push_back(t);
    trace.J.push_back(0.2 * Matrix3::Identity());
    trace.v.push_back({0.2 * qd, 0.0, 0.0});
  }
  return trace;
}

VelocityScore scored(const VelocityEstimator::Config& config, const VelocityTrace& trace) {
  const std::vector traces{trace, trace};
  const auto estimate = run_estimator(config, trace);
  const std::vector estimates{estimate, estimate};
  return score(traces, estimates);
}

TEST(VelocityScore, FindsTheLagOfAMean) {
  for (const int samples : {20, 60, 100}) {
    const VelocityScore s = scored({.kind = "mean", .mean = {.samples = samples}}, swing(47513.6));
    EXPECT_NEAR(s.lag_s, samples * kPeriod / 2.0, 0.2e-3) << samples;
    EXPECT_LT(s.noise_m_per_s, 1e-3) << "a smooth estimate has no noise, however late";
  }
}

TEST(VelocityScore, FindsTheNoiseOfAFirstDifference) {
  // Rounding is white at these speeds: √2 Δ/√12/Δt, of which 95 % is above 25 Hz.
  const VelocityTrace trace = swing(47513.6, 0.5, true);
  const VelocityScore s = scored({.difference = {.cutoff_Hz = 0.0}}, trace);
  const double quantum = 2.0 * std::numbers::pi / 47513.6;
  const double stated = 0.2 * quantum * std::sqrt(2.0 / 12.0) / kPeriod;
  EXPECT_NEAR(s.noise_m_per_s / stated, 1.0, 0.08);
  EXPECT_NEAR(s.lag_s, kPeriod / 2.0, 0.1e-3);
}

TEST(VelocityScore, SortsErrorsBySpeedAndCountsEverySampleOnce) {
  const VelocityTrace trace = swing(47513.6, 0.1, true);
  const VelocityScore s = scored({.difference = {.cutoff_Hz = 0.0}}, trace);
  std::size_t samples = 0;
  for (const SpeedClass& c : s.classes) {
    samples += c.samples;
    EXPECT_GT(c.samples, 0U);
    // A count a sample is 26 mm/s.
    EXPECT_LE(c.worst_m_per_s, 0.2 * 2.0 * std::numbers::pi / 47513.6 / kPeriod + 0.5e-3);
    EXPECT_GE(c.worst_m_per_s, c.rms_m_per_s);
  }
  EXPECT_EQ(samples, 2U * 3750U) << "a quarter of a second is left out";
}

TEST(VelocityScore, OfNothingIsZero) {
  const VelocityScore s = score({}, {});
  EXPECT_EQ(s.lag_s, 0.0);
  EXPECT_EQ(s.noise_m_per_s, 0.0);
}

}  // namespace
}  // namespace teleop
