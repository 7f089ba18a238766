#include "transport/clock_sync.hpp"

#include <algorithm>

namespace teleop {
namespace {

constexpr Duration kRounding{1};  // of a division by two

Duration drift_over(Duration time) noexcept {
  const Duration length = time < Duration{0} ? -time : time;
  return Duration{static_cast<Duration::rep>(kMaxDrift * static_cast<double>(length.count()))} +
         kRounding;
}

Duration half_width_at(const ClockSync::State& state, Instant now) noexcept {
  return state.half_width + drift_over(now - state.at);
}

}  // namespace

void ClockSync::step(const Exchange& exchange) noexcept {
  const Duration low = exchange.answered.time_since_epoch() - exchange.received.time_since_epoch();
  const Duration high =
      exchange.answered.time_since_epoch() - exchange.held - exchange.asked.time_since_epoch();
  const Duration round_trip = std::max(high - low, Duration{0});
  const State seen{.known = true,
                   .offset = low + (high - low) / 2,
                   .half_width = round_trip / 2 + drift_over(exchange.received - exchange.asked),
                   .at = exchange.received};

  const Duration kept_half_width = half_width_at(state_, seen.at);
  const Duration apart = std::max(seen.offset - state_.offset, state_.offset - seen.offset);
  const bool stepped = apart > seen.half_width + kept_half_width;
  if (!state_.known || stepped || seen.half_width <= kept_half_width) state_ = seen;
}

ClockSync::Delay ClockSync::delay(Instant sent, Instant received) const noexcept {
  if (!state_.known) return {};
  const Duration middle = received.time_since_epoch() - sent.time_since_epoch() + state_.offset;
  const Duration upper = middle + half_width_at(state_, received);
  // An arrival before the earliest possible sending is no measurement: a clock was stepped.
  if (upper < Duration{0} || upper >= kUnknownDelay) return {};
  // The offset drifts while the packet travels: d ≤ upper + ρ d.
  const auto bound = static_cast<double>(upper.count()) / (1.0 - kMaxDrift);
  return {.one_way = std::max(middle, Duration{0}),
          .bound = Duration{static_cast<Duration::rep>(bound)} + kRounding};
}

}  // namespace teleop
