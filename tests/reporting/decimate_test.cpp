#include "core/reporting/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(TimeGrid, IsNoFinerThanAskedAndHasNoMoreBucketsThanAllowed) {
  const TimeGrid fine = TimeGrid::over(1.0, 0.002, 2000);
  EXPECT_DOUBLE_EQ(fine.bucket_s, 0.002);
  EXPECT_EQ(fine.buckets, 501U);
  const TimeGrid coarse = TimeGrid::over(600.0, 0.002, 2000);
  EXPECT_EQ(coarse.buckets, 2000U);
  EXPECT_EQ(coarse.bucket_of(600.0), 1999U);
  EXPECT_EQ(coarse.bucket_of(0.0), 0U);
  EXPECT_FALSE(coarse.bucket_of(600.1));
  EXPECT_FALSE(coarse.bucket_of(-0.1));
  EXPECT_FALSE(coarse.bucket_of(kNone));
}

TEST(TimeGrid, OfARunWithoutLengthHasABucket) {
  EXPECT_EQ(TimeGrid::over(0.0, 0.002, 2000).bucket_of(0.0), 0U);
  EXPECT_EQ(TimeGrid::over(kNone, 0.002, 2000).buckets, 2U);
}

TEST(Decimate, KeepsTheExtremesOfEveryBucketInTheirOrder) {
  const TimeGrid grid{.bucket_s = 1.0, .buckets = 3};
  const std::vector<double> t_s{0.1, 0.2, 0.3, 0.9, 1.1, 1.2, 1.3};
  const std::vector<double> values{0.0, -5.0, 1.0, 7.0, 9.0, 2.0, 3.0};

  const std::vector<double> points = decimate(grid, t_s, values);

  ASSERT_EQ(points.size(), 6U);
  EXPECT_EQ((std::vector<double>{points.begin(), points.begin() + 4}),
            (std::vector<double>{-5.0, 7.0, 9.0, 2.0}));
  EXPECT_TRUE(std::isnan(points[4]));
  EXPECT_TRUE(std::isnan(points[5]));
}

TEST(Decimate, LosesNoPeakOfALongRun) {
  constexpr std::size_t kTurns = 600'000;
  const TimeGrid grid = TimeGrid::over(600.0, 0.002, 2000);
  Random random{11};
  std::vector<double> t_s(kTurns);
  std::vector<double> values(kTurns);
  for (std::size_t i = 0; i < kTurns; ++i) {
    t_s[i] = 0.001 * static_cast<double>(i);
    values[i] = random.normal();
  }
  values[123'457] = 1e3;
  values[123'459] = -1e3;
  values[400'000] = kNone;

  const std::vector<double> points = decimate(grid, t_s, values);

  EXPECT_LE(points.size(), 4000U);
  EXPECT_EQ(*std::max_element(points.begin(), points.end()), 1e3);
  EXPECT_EQ(*std::min_element(points.begin(), points.end()), -1e3);
  EXPECT_EQ(std::count_if(points.begin(), points.end(), [](double p) { return std::isnan(p); }), 0);
}

TEST(Decimate, PassesEveryValueWhereABucketHoldsTwo) {
  const TimeGrid grid{.bucket_s = 0.002, .buckets = 50};
  std::vector<double> t_s;
  std::vector<double> values;
  Random random{5};
  for (int i = 0; i < 100; ++i) {
    t_s.push_back(0.001 * i + 0.0005);
    values.push_back(random.uniform());
  }
  EXPECT_EQ(decimate(grid, t_s, values), values);
}

}  // namespace
}  // namespace teleop
