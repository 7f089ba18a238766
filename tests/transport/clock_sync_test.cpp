#include "transport/clock_sync.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

std::size_t cases(std::size_t usual) {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe): one thread
  return text == nullptr ? usual : static_cast<std::size_t>(std::strtoull(text, nullptr, 10));
}

Instant at(Duration time) { return Instant{time}; }

/// Two hosts in true time: the own clock shows it, the peer's is offset and runs at another rate.
struct Hosts {
  Duration offset{};
  double drift = 0.0;

  [[nodiscard]] Instant peer(Duration now) const {
    return at(now + offset + Duration{static_cast<std::int64_t>(drift * double(now.count()))});
  }

  /// A request at `start`, an answer at once after `hold`.
  [[nodiscard]] ClockSync::Exchange exchange(Duration start,
                                             Duration out,
                                             Duration hold,
                                             Duration in) const {
    const Duration arrived = start + out;
    const Duration answered = arrived + hold;
    return {.asked = at(start),
            .held = peer(answered) - peer(arrived),
            .answered = peer(answered),
            .received = at(answered + in)};
  }
};

Duration random_delay(Random& random) {
  // Some splits put the whole round trip on one side.
  const double kind = random.uniform();
  if (kind < 0.2) return Duration{0};
  const double scale = kind < 0.9 ? 1e5 : 5e7;
  return nanoseconds{static_cast<std::int64_t>(random.uniform() * random.uniform() * scale)};
}

TEST(ClockSync, KnowsNothingBeforeTheFirstExchange) {
  EXPECT_EQ(ClockSync{}.delay(at({}), at({})).bound, kUnknownDelay);
}

TEST(ClockSync, BoundsEveryDelayForAnySplitOfTheRoundTrip) {
  Random random{11};
  for (std::size_t run = 0; run < cases(200); ++run) {
    const Hosts hosts{.offset = milliseconds{1000 + static_cast<int>(random.uniform() * 1e6)},
                      .drift = random.uniform(-kMaxDrift, kMaxDrift)};
    ClockSync sync;
    Duration now{0};
    for (int i = 0; i < 200; ++i) {
      now += microseconds{static_cast<int>(random.uniform() * 5000.0)};
      const Duration in = random_delay(random);
      const auto exchange = hosts.exchange(now, random_delay(random), random_delay(random), in);
      sync.step(exchange);
      const auto delay = sync.delay(exchange.answered, exchange.received);
      ASSERT_GE(delay.bound, in) << "run " << run << ", exchange " << i;
      ASSERT_LE(delay.one_way, delay.bound);
      ASSERT_LE(delay.one_way - in, delay.bound - delay.one_way) << "further off than half a trip";
    }
  }
}

TEST(ClockSync, IsRightWhenBothWaysTakeTheSameTime) {
  const Hosts hosts{.offset = milliseconds{77}};
  ClockSync sync;
  sync.step(hosts.exchange(milliseconds{5}, microseconds{30}, microseconds{900}, microseconds{30}));

  const auto delay =
      sync.delay(hosts.peer(milliseconds{6}), at(milliseconds{6} + microseconds{50}));

  EXPECT_NEAR(double(delay.one_way.count()), 50e3, 2.0);
  EXPECT_NEAR(double(delay.bound.count()), 50e3 + 30e3, 1.3e3) << "half a trip and the drift";
}

TEST(ClockSync, LearnsFromTheFastestExchange) {
  const Hosts hosts{.offset = milliseconds{-3}};
  ClockSync sync;
  sync.step(hosts.exchange(milliseconds{10}, milliseconds{4}, {}, milliseconds{0}));
  sync.step(hosts.exchange(milliseconds{20}, microseconds{10}, {}, microseconds{10}));
  sync.step(hosts.exchange(milliseconds{21}, milliseconds{9}, {}, milliseconds{0}));

  EXPECT_NEAR(double(sync.state().offset.count()), -3e6, 10e3);
}

TEST(ClockSync, FollowsAClockThatDrifts) {
  const Hosts hosts{.offset = milliseconds{500}, .drift = 0.9 * kMaxDrift};
  ClockSync sync;
  Duration now{0};
  Duration worst{0};
  for (int i = 0; i < 60'000; ++i) {
    now += milliseconds{1};
    const auto exchange =
        hosts.exchange(now, microseconds{20}, microseconds{500}, microseconds{20});
    sync.step(exchange);
    const auto delay = sync.delay(exchange.answered, exchange.received);
    ASSERT_GE(delay.bound, microseconds{20});
    worst = std::max(worst, delay.bound);
  }
  EXPECT_LT(worst, microseconds{50}) << "a minute of drift is 54 ms";
}

TEST(ClockSync, RecoversFromASteppedClock) {
  const Hosts before{.offset = milliseconds{100}};
  const Hosts after{.offset = milliseconds{-900}};
  ClockSync sync;
  sync.step(before.exchange(milliseconds{1}, microseconds{20}, {}, microseconds{20}));

  EXPECT_GE(sync.delay(after.peer(milliseconds{2}), at(milliseconds{2})).bound, milliseconds{999})
      << "a suspended peer looks old, never fresh";
  const auto exchange = after.exchange(milliseconds{3}, microseconds{60}, {}, microseconds{60});
  sync.step(exchange);

  const auto delay = sync.delay(exchange.answered, exchange.received);
  EXPECT_GE(delay.bound, microseconds{60});
  EXPECT_LT(delay.bound, microseconds{130});
}

TEST(ClockSync, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  ClockSync sync;
  const testing::NoAllocation guard;
  sync.step({.received = at(milliseconds{1})});
  EXPECT_LE(sync.delay(at({}), at({})).one_way, kUnknownDelay);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
