#pragma once

#include "core/base/time.hpp"

namespace teleop {

/// How far two monotonic clocks run apart at most: both slewed by 500 ppm, the most that NTP does.
inline constexpr double kMaxDrift = 1e-3;

/// Stands for a delay of which nothing is known, so that a bound is never too small.
inline constexpr Duration kUnknownDelay = std::chrono::hours{1};

/// Bounds the time that packets of the peer were on the way, although its clock is not ours.
///
/// With θ = peer's clock − own clock, a request sent at T1, held by the peer for h, answered at T3
/// (peer's clock) and received at T4 tells, since no delay is negative,
///
///     T3 − T4  ≤  θ  ≤  T3 − h − T1,        round trip r = T4 − T1 − h,
///
/// an interval of width r, however the two directions share r [Mills 1991]. Clocks drift, so it
/// widens by ±ρ a second; of all exchanges the one that is narrowest now is kept. All widen alike,
/// so comparing each new one with the one kept is exact and needs no window. A new interval that
/// does not touch the one kept shows a stepped clock (a suspended PC) and replaces it.
///
/// A packet sent at S and received at t was on the way for t − S + θ: `one_way` takes the middle of
/// the interval, `bound` its upper end, half the smallest round trip more.
///
/// Thread: one. Loop: neither allocates, blocks nor throws.
class ClockSync {
 public:
  /// One question and answer. Times stay below 2^60 ns.
  struct Exchange {
    Instant asked{};     ///< T1, own clock
    Duration held{};     ///< h, 0 or more
    Instant answered{};  ///< T3, peer's clock
    Instant received{};  ///< T4, own clock, after T1
  };

  struct State {
    bool known = false;
    Duration offset{};      ///< θ, middle of the interval
    Duration half_width{};  ///< of the interval at `at`
    Instant at{};           ///< own clock
  };

  struct Delay {
    Duration one_way{};
    Duration bound = kUnknownDelay;
  };

  void step(const Exchange& exchange) noexcept;

  /// Of a packet sent at `sent` (peer's clock) and received at `received` (own clock).
  [[nodiscard]] Delay delay(Instant sent, Instant received) const noexcept;

  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  State state_{};
};

}  // namespace teleop
