#include "core/realtime/loop.hpp"

#include <gtest/gtest.h>

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only

TEST(Loop, KeepsItsPeriodInSimulatedTime) {
  SimulatedClock clock;

  const auto statistics = run_periodically(clock, 1ms, [](const Tick& tick) noexcept {
    EXPECT_EQ(tick.elapsed, 1ms);
    EXPECT_EQ(tick.lateness(), 0ns);
    return tick.index == 9'999 ? Next::stop : Next::again;
  });

  EXPECT_EQ(statistics.turns, 10'000U);
  EXPECT_EQ(statistics.overruns, 0U);
  EXPECT_EQ(clock.now().time_since_epoch(), 9'999ms);
}

TEST(Loop, CountsAnOverrunAndDoesNotCatchUp) {
  SimulatedClock clock;

  const auto statistics = run_periodically(clock, 1ms, [&](const Tick& tick) noexcept {
    EXPECT_EQ(tick.overrun, tick.index == 4);
    if (tick.index == 3) clock.sleep_until(tick.now + 5500us);
    return tick.index == 5 ? Next::stop : Next::again;
  });

  EXPECT_EQ(statistics.overruns, 1U);
  EXPECT_EQ(statistics.missed, 5U);
  EXPECT_EQ(clock.now().time_since_epoch(), 10ms) << "turn 4 at 9 ms, on the grid";
}

/// Wakes late by a fixed time, as a busy machine does.
class LateClock final : public Clock {
 public:
  [[nodiscard]] Instant now() noexcept override { return now_; }
  void sleep_until(Instant when) noexcept override { now_ = when + 200us; }

 private:
  Instant now_{};
};

TEST(Loop, DoesNotDriftWhenItWakesLate) {
  LateClock clock;

  const auto statistics = run_periodically(clock, 1ms, [](const Tick& tick) noexcept {
    return tick.index == 1000 ? Next::stop : Next::again;
  });

  EXPECT_EQ(statistics.missed, 0U);
  EXPECT_EQ(clock.now().time_since_epoch(), 1000ms + 200us);
}

}  // namespace
}  // namespace teleop
