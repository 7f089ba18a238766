#include "core/reporting/distribution.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace teleop {
namespace {

TEST(Distribution, OfTheNumbersOneToThousandIsTheirRank) {
  std::vector<double> values(1000);
  std::iota(values.begin(), values.end(), 1.0);
  std::reverse(values.begin(), values.end());

  const Distribution d = distribution(values);

  EXPECT_EQ(d.count, 1000U);
  EXPECT_EQ(d.p50, 500.0);
  EXPECT_EQ(d.p90, 900.0);
  EXPECT_EQ(d.p99, 990.0);
  EXPECT_EQ(d.p999, 999.0);
  EXPECT_EQ(d.max, 1000.0);
}

TEST(Distribution, OfOneValueIsThatValue) {
  const Distribution d = distribution({4.5});
  EXPECT_EQ(d.p50, 4.5);
  EXPECT_EQ(d.p999, 4.5);
  EXPECT_EQ(d.max, 4.5);
}

TEST(Distribution, LeavesOutWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(distribution({nan, 1.0, nan}).count, 1U);
  EXPECT_EQ(distribution({nan}).count, 0U);
}

TEST(Distribution, HasTheStatedShareAtOrBelowEveryPercentile) {
  Random random{3};
  for (std::size_t n = 1; n < 200; ++n) {
    std::vector<double> values(n);
    for (double& value : values) {
      value = random.normal();
    }
    const Distribution d = distribution(values);
    const auto share = [&](double limit) {
      const auto below = std::count_if(values.begin(), values.end(),
                                       [limit](double value) { return value <= limit; });
      return static_cast<double>(below) / static_cast<double>(n);
    };
    EXPECT_GE(share(d.p90), 0.9) << n;
    EXPECT_LT(share(d.p90) - 1.0 / static_cast<double>(n), 0.9) << n;
    EXPECT_GE(share(d.p999), 0.999) << n;
  }
}

TEST(LogHistogram, CountsEveryValueOnceAndKeepsOutliersAtTheEnds) {
  const std::vector<double> values{-1.0, 0.0, 0.5, 5.0, 50.0, 99.0, 100.0, 1e9};

  const Histogram histogram = log_histogram(values, 1.0, 100.0, 2);

  ASSERT_EQ(histogram.edges.size(), 3U);
  EXPECT_NEAR(histogram.edges[1], 10.0, 1e-12);
  EXPECT_EQ(histogram.counts, (std::vector<std::uint64_t>{4, 4}));
}

}  // namespace
}  // namespace teleop
