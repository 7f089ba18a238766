#include <array>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "core/realtime/histogram.hpp"
#include "core/realtime/mailbox.hpp"
#include "core/realtime/ring.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only

/// Every element equal: a torn copy shows.
using Block = std::array<std::uint64_t, 32>;

Block block_of(std::uint64_t value) {
  Block block{};
  block.fill(value);
  return block;
}

bool whole(const Block& block) {
  for (const std::uint64_t value : block) {
    if (value != block[0]) return false;
  }
  return true;
}

constexpr std::uint64_t kMany = 200'000;

TEST(Ring, DeliversEverythingOnceAndInOrderAcrossThreads) {
  Ring<Block> ring{64};
  std::thread writer{[&] {
    for (std::uint64_t i = 0; i < kMany;) {
      if (ring.push(block_of(i))) ++i;
    }
  }};

  Block block{};
  for (std::uint64_t expected = 0; expected < kMany;) {
    if (!ring.pop(block)) continue;
    ASSERT_TRUE(whole(block));
    ASSERT_EQ(block[0], expected);
    ++expected;
  }
  writer.join();
  EXPECT_FALSE(ring.pop(block));
}

TEST(Ring, RefusesWhenFullAndLosesNothing) {
  Ring<int> ring{4};
  for (int i = 0; i < 4; ++i)
    EXPECT_TRUE(ring.push(i));

  EXPECT_FALSE(ring.push(99));

  int value = -1;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
}

TEST(Mailbox, NeverTearsAndNeverGoesBackAcrossThreads) {
  Mailbox<Block> mailbox;
  std::thread writer{[&] {
    for (std::uint64_t i = 1; i <= kMany; ++i)
      mailbox.put(block_of(i));
  }};

  Block block{};
  std::uint64_t last = 0;
  while (last < kMany) {
    if (!mailbox.take(block)) continue;
    ASSERT_TRUE(whole(block));
    ASSERT_GT(block[0], last);
    last = block[0];
  }
  writer.join();
}

TEST(Mailbox, GivesEachValueOnce) {
  Mailbox<int> mailbox;
  int value = 0;
  EXPECT_FALSE(mailbox.take(value));
  mailbox.put(1);
  mailbox.put(2);
  EXPECT_TRUE(mailbox.take(value));
  EXPECT_EQ(value, 2);
  EXPECT_FALSE(mailbox.take(value));
}

TEST(Histogram, GivesQuantilesWithinItsResolution) {
  Histogram histogram;
  for (int us = 1; us <= 1000; ++us)
    histogram.record(std::chrono::microseconds{us});

  EXPECT_EQ(histogram.count(), 1000U);
  EXPECT_NEAR(seconds(histogram.quantile(0.5)), 500e-6, 500e-6 / 16);
  EXPECT_NEAR(seconds(histogram.quantile(0.99)), 990e-6, 990e-6 / 16);
  EXPECT_GE(histogram.quantile(1.0), 1000us);
}

TEST(Histogram, TakesWhatIsOutOfRange) {
  Histogram histogram;
  histogram.record(-5ns);
  histogram.record(std::chrono::hours{1});
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.quantile(0.5), 0ns);
}

TEST(Exchange, NeverAllocates) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Ring<Block> ring{8};
  Mailbox<Block> mailbox;
  Histogram histogram;
  Block block{};

  const testing::NoAllocation guard;
  ASSERT_TRUE(ring.push(block));
  ASSERT_TRUE(ring.pop(block));
  mailbox.put(block);
  ASSERT_TRUE(mailbox.take(block));
  histogram.record(1us);
  EXPECT_EQ(guard.count(), 0U);
}

TEST(NoAllocation, SeesAnAllocation) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const testing::NoAllocation guard;
  const std::vector<int> heap(1000);
  const int* volatile kept = heap.data();  // or the optimiser drops the allocation
  EXPECT_GE(guard.count(), 1U) << kept;
}

}  // namespace
}  // namespace teleop
