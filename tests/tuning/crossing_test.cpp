#include "core/tuning/crossing.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace teleop {
namespace {

/// Growth at gains about 1000: slope, bend and dependence on amplitude as given, with noise.
std::vector<GrowthPoint> points_of(
    Random& random, double claimed, double true_std, double bend, double on_amplitude) {
  std::vector<GrowthPoint> points;
  for (int i = 0; i < 10; ++i) {
    const double u = random.uniform(-0.06, 0.06);
    const double a = random.uniform(-0.3, 0.3);
    points.push_back(
        {.gain = 1000.0 * std::exp(u),
         .growth_per_s = 15.0 * u + bend * u * u + on_amplitude * a + true_std * random.normal(),
         .std_per_s = claimed,
         .log_amplitude = a});
  }
  return points;
}

double coverage(double claimed, double true_std, double bend, double on_amplitude) {
  Random random{5};
  int covered = 0;
  constexpr int kCases = 1000;
  for (int i = 0; i < kCases; ++i) {
    const auto crossing = find_crossing(points_of(random, claimed, true_std, bend, on_amplitude));
    if (crossing && crossing->low <= 1000.0 && 1000.0 <= crossing->high) ++covered;
  }
  return static_cast<double>(covered) / kCases;
}

TEST(Crossing, IsWhereAStraightLinePassesZero) {
  std::vector<GrowthPoint> points;
  for (const double u : {-0.05, -0.03, 0.01, 0.04})
    points.push_back({.gain = 500.0 * std::exp(u), .growth_per_s = 20.0 * u, .std_per_s = 0.01});
  const auto crossing = find_crossing(points);
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->gain, 500.0, 1e-3);
  EXPECT_NEAR(crossing->slope_per_s, 20.0, 1e-3);
  EXPECT_LT(crossing->relative_width(), 0.01);
}

TEST(Crossing, CoversTheTruthNineTimesInTen) {
  EXPECT_NEAR(coverage(0.1, 0.1, 0.0, 0.0), 0.93, 0.05);
}

TEST(Crossing, CoversItWhenThePointsScatterTenTimesWhatTheyClaim) {
  EXPECT_NEAR(coverage(0.02, 0.2, 0.0, 0.0), 0.92, 0.04);
}

TEST(Crossing, CoversItWhenGrowthBendsAndDependsOnAmplitude) {
  EXPECT_GT(coverage(0.05, 0.05, 7.0, 0.0), 0.88);
  EXPECT_GT(coverage(0.05, 0.05, 0.0, 7.0), 0.86);
}

TEST(Crossing, IsAbsentWhereGrowthDoesNotRiseWithTheGain) {
  Random random{6};
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<GrowthPoint> points;
    for (int k = 0; k < 8; ++k) {
      points.push_back({.gain = random.uniform(950.0, 1050.0),
                        .growth_per_s = random.normal(),
                        .std_per_s = 0.1});
    }
    if (find_crossing(points)) ++found;
  }
  // A slope by chance: one side of a 90 % interval.
  EXPECT_LT(found, 30);
  EXPECT_FALSE(find_crossing({}));
}

}  // namespace
}  // namespace teleop
