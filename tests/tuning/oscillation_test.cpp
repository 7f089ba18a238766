#include "core/tuning/oscillation.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace teleop {
namespace {

struct Term {
  double amplitude = 0.0;
  double growth = 0.0;
  double frequency_Hz = 0.0;
  double phase = 0.0;
  double bend = 0.0;  ///< of the growth, 1/s², from the record's middle
};

struct Trace {
  std::vector<double> t;
  std::vector<double> y;
  [[nodiscard]] Record record() const { return {.t_s = t, .y = y}; }
};

/// The sum of some terms, read in whole quanta; amplitudes hold in the middle of the record.
Trace trace_of(const std::vector<Term>& terms, double seconds, double quantum, double offset) {
  Trace trace;
  constexpr double kPeriod = 1e-3;
  const int samples = static_cast<int>(seconds / kPeriod);
  for (int k = 0; k < samples; ++k) {
    const double t = k * kPeriod;
    const double tau = t - 0.5 * (samples - 1) * kPeriod;
    double y = offset;
    for (const Term& term : terms) {
      y += term.amplitude * std::exp(term.growth * tau + 0.5 * term.bend * tau * tau) *
           std::cos(2.0 * std::numbers::pi * term.frequency_Hz * tau + term.phase);
    }
    trace.t.push_back(t);
    trace.y.push_back(quantum > 0.0 ? quantum * std::round(y / quantum) : y);
  }
  return trace;
}

int cases() {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return text != nullptr ? std::atoi(text) : 150;
}

TEST(Oscillation, IsExactWithoutNoise) {
  const Trace trace = trace_of({{3e-4, 1.7, 23.4, 0.3}, {1e-4, -8.0, 71.0, 1.0}}, 0.5, 0.0, 2e-3);
  const auto found = fit_oscillations(trace.record(), 1e-9, 3e-4);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].growth_per_s, 1.7, 1e-6);
  EXPECT_NEAR(found[0].frequency_Hz, 23.4, 1e-6);
  EXPECT_NEAR(found[0].amplitude_here, 3e-4, 1e-9);
  EXPECT_NEAR(found[1].growth_per_s, -8.0, 1e-5);
}

TEST(Oscillation, DominantIsTheOneThatDiesSlowestNotTheLargest) {
  const Trace trace = trace_of({{6e-4, -6.0, 20.0, 0.0}, {2e-4, -0.5, 60.0, 0.4}}, 0.5, 20e-6, 0.0);
  const auto found = fit_oscillations(trace.record(), 20e-6 / std::sqrt(12.0), 3e-4);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found[0].frequency_Hz, 60.0, 0.2);
  EXPECT_NEAR(found[0].growth_per_s, -0.5, 0.3);
}

TEST(Oscillation, IsAbsentInAMotionThatOnlyCreeps) {
  const Trace trace = trace_of({{1e-3, -9.0, 0.0, 0.0}}, 0.5, 20e-6, 1e-3);
  EXPECT_TRUE(fit_oscillations(trace.record(), 20e-6 / std::sqrt(12.0), 3e-4).empty());
}

TEST(Oscillation, IsAbsentInRounding) {
  Random random{3};
  for (int i = 0; i < 20; ++i) {
    const Trace trace =
        trace_of({{0.3 * 20e-6, random.uniform(-1.0, 1.0), random.uniform(10.0, 80.0), 0.0}}, 0.5,
                 20e-6, random.uniform(0.0, 1e-3));
    EXPECT_TRUE(fit_oscillations(trace.record(), 20e-6 / std::sqrt(12.0), 3e-4).empty()) << i;
  }
}

TEST(Oscillation, GrowthThatDependsOnAmplitudeIsTakenAtTheAmplitudeAskedFor) {
  // a(τ) = A e^{ρ τ²/2}: at rest with itself where it has its smallest amplitude, in the middle.
  const Trace trace = trace_of({{2e-4, 0.0, 40.0, 0.0, 20.0}}, 0.6, 5e-6, 0.0);
  const double tau = 0.1;
  const double there = 2e-4 * std::exp(0.5 * 20.0 * tau * tau);
  const auto found = fit_oscillations(trace.record(), 5e-6 / std::sqrt(12.0), there);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(std::abs(found[0].growth_per_s), 20.0 * tau, 0.15);
  EXPECT_NEAR(found[0].amplitude_here, there, 0.03 * there);
}

/// White noise, not rounding: the deviations claimed are those of the estimates.
TEST(Oscillation, ClaimsTheDeviationThatItsGrowthHas) {
  Random random{11};
  double square = 0.0;
  const int count = cases();
  for (int i = 0; i < count; ++i) {
    const Term term{.amplitude = 3e-4,
                    .growth = random.uniform(-4.0, 4.0),
                    .frequency_Hz = random.uniform(8.0, 90.0),
                    .phase = random.uniform(0.0, 6.0)};
    Trace trace = trace_of({term}, 0.4, 0.0, random.uniform(-1e-3, 1e-3));
    for (double& y : trace.y)
      y += 8e-6 * random.normal();
    const auto found = fit_oscillations(trace.record(), 8e-6, 3e-4);
    ASSERT_FALSE(found.empty()) << i;
    square += std::pow((found[0].growth_per_s - term.growth) / found[0].growth_std_per_s, 2);
  }
  const double ratio = std::sqrt(square / count);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.25);
}

}  // namespace
}  // namespace teleop
