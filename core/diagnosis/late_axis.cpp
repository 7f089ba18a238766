#include "core/diagnosis/late_axis.hpp"

#include <cmath>

#include "core/base/contract.hpp"

namespace teleop {

LateAxis::LateAxis(const Config& config)
    : config_{config},
      pieces_{static_cast<std::size_t>(std::ceil(config.delay_s / config.period_s - 1e-9))},
      underway_(pieces_) {
  expects(pieces_ > 0, "a late axis has a delay");
}

LateAxis::State LateAxis::carried(const State& state, double time_s, double memory) const noexcept {
  const double jump = time_s * config_.mobility * state.d;
  return {
      .q = state.q + time_s * (state.v + jump / 2.0), .v = state.v + jump, .d = memory * state.d};
}

LateAxis::State LateAxis::take(const State& correction) noexcept {
  then_.q += correction.q;
  then_.v += correction.v;
  then_.d += correction.d;
  const double step = config_.delay_s / static_cast<double>(pieces_);
  const double memory = std::pow(config_.memory, step / config_.period_s);
  State now = correction;
  for (std::size_t i = 0; i < pieces_; ++i) {
    now = carried(now, step, memory);
  }
  then_ = carried(then_, config_.period_s, config_.memory);
  // What was added so many samples ago is in the reading from the next one on, carried by the rest
  // of a sample.
  underway_[next_] = now;
  next_ = (next_ + 1) % pieces_;
  const double rest = static_cast<double>(pieces_) * config_.period_s - config_.delay_s;
  const State seen =
      carried(underway_[next_], rest, std::pow(config_.memory, rest / config_.period_s));
  then_.q -= seen.q;
  then_.v -= seen.v;
  then_.d -= seen.d;
  return now;
}

}  // namespace teleop
