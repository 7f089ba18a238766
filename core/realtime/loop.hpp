#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/time.hpp"
#include "core/realtime/clock.hpp"

namespace teleop {

/// One turn of a loop, as its body sees it.
struct Tick {
  std::uint64_t index = 0;
  Instant due{};             ///< when this turn should have begun
  Instant now{};             ///< when it began
  Duration elapsed{};        ///< since the previous turn began; the period on the first turn
  bool overrun = false;      ///< the previous turn ran past its end
  std::uint64_t missed = 0;  ///< turns of the schedule that never happened, so far

  [[nodiscard]] Duration lateness() const noexcept { return now - due; }
};

enum class Next { again, stop };

struct LoopStatistics {
  std::uint64_t turns = 0;
  std::uint64_t overruns = 0;  ///< turns that ran past the next one's time
  std::uint64_t missed = 0;    ///< turns of the schedule that never happened
};

/// What a loop may call: it takes a tick, says what is next and cannot throw.
template <class Body>
concept LoopBody = std::is_nothrow_invocable_r_v<Next, Body&, const Tick&>;

/// Calls `body` once a period, on a fixed grid of times, until it returns Next::stop. A turn that
/// runs past the next one's time costs the turns it covered: they are counted, never caught up,
/// and the loop goes on at the next time of the grid.
template <LoopBody Body>
LoopStatistics run_periodically(Clock& clock, Duration period, Body&& body) noexcept {
  const Instant start = clock.now();
  LoopStatistics statistics;
  Tick tick{.due = start, .now = start, .elapsed = period};
  while (true) {
    ++statistics.turns;
    if (body(tick) == Next::stop) return statistics;
    Instant due = tick.due + period;
    const Instant done = clock.now();
    const bool overrun = done > due;
    if (overrun) {
      const auto covered = (done - due) / period + 1;
      due += covered * period;
      ++statistics.overruns;
      statistics.missed += static_cast<std::uint64_t>(covered);
    }
    clock.sleep_until(due);
    const Instant now = clock.now();
    tick = {.index = tick.index + 1,
            .due = due,
            .now = now,
            .elapsed = now - tick.now,
            .overrun = overrun,
            .missed = statistics.missed};
  }
}

}  // namespace teleop
