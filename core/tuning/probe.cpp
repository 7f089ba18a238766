#include "core/tuning/probe.hpp"

#include <algorithm>
#include <cmath>

namespace teleop {
namespace {

constexpr double kRestCounts = 3.0;
constexpr double kLookAhead_s = 0.005;

}  // namespace

std::string_view name_of(ProbeStop stop) noexcept {
  switch (stop) {
    case ProbeStop::time:
      return "time";
    case ProbeStop::decayed:
      return "decayed";
    case ProbeStop::grew:
      return "grew";
    case ProbeStop::speed:
      return "speed";
    case ProbeStop::force:
      return "force";
    case ProbeStop::travel:
      return "travel";
    case ProbeStop::energy:
      return "energy";
    case ProbeStop::fault:
      return "fault";
    case ProbeStop::restless:
      return "restless";
    case ProbeStop::abandoned:
      return "abandoned";
  }
  return "unknown";
}

Probe::Probe(const Config& config, LoopUnderTest& loop)
    : config_{config}, loop_{&loop}, axis_{static_cast<Eigen::Index>(loop.config().axis)} {
  const auto most = static_cast<std::size_t>(config.longest_watch_s / config.period_s) + 2;
  trace_.t_s.resize(most);
  for (auto& side : trace_.displacement) {
    side.resize(most);
  }
}

void Probe::begin(const ProbePlan& plan) noexcept {
  plan_ = plan;
  plan_.watch_s = std::min(plan.watch_s, config_.longest_watch_s);
  outcome_ = {};
  trace_.size = 0;
  work_J_ = 0.0;
  has_last_ = false;
  abandoned_ = false;
  go(Phase::settle);
}

void Probe::go(Phase next) noexcept {
  phase_ = next;
  in_phase_ = 0;
  on_level_ = 0;
  small_for_ = 0;
  if (next == Phase::push) return;  // the window goes on
  const double window_s = next == Phase::watch ? plan_.period_s : rest_window_s();
  const double ticks = window_s / config_.period_s;
  stride_ = std::max(1, static_cast<int>(std::ceil(ticks / static_cast<double>(kWindow))));
  since_kept_ = 0;
  newest_ = 0;
  filled_ = 0;
}

/// A turning point is no rest: the window covers a period.
double Probe::rest_window_s() const noexcept {
  return std::clamp(plan_.period_s, kRest_s, kLongestRest_s);
}

/// Half the peak to peak of the tool that moves most, over the last `window` positions kept.
double Probe::amplitude(std::size_t window) const noexcept {
  double largest = 0.0;
  const std::size_t count = std::min(window, filled_);
  for (std::size_t i = 0; i < loop_->arms() && count > 0; ++i) {
    double low = recent_[i][newest_];
    double high = low;
    for (std::size_t k = 1; k < count; ++k) {
      const double x = recent_[i][(newest_ + kWindow - k) % kWindow];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    largest = std::max(largest, 0.5 * (high - low));
  }
  return largest;
}

void Probe::measure(const LoopUnderTest::Turn& turn, double dt) noexcept {
  time_s_ += dt;
  const bool keep = since_kept_ == 0;
  since_kept_ = (since_kept_ + 1) % stride_;
  if (keep) {
    newest_ = (newest_ + 1) % kWindow;
    filled_ = std::min(filled_ + 1, kWindow);
  }
  for (std::size_t i = 0; i < loop_->arms(); ++i) {
    const double x = turn.displacement[i][axis_];
    if (keep) recent_[i][newest_] = x;
    outcome_.peak_travel_m = std::max(outcome_.peak_travel_m, std::abs(x));
    outcome_.peak_force_N = std::max(outcome_.peak_force_N, std::abs(turn.force_N[i]));
    last_x_[i] = x;
    last_force_[i] = turn.force_N[i];
  }
  has_last_ = true;
}

/// Looks at the readings alone, before any force is computed from them.
void Probe::look_at_bounds(const std::array<ArmState, kMostArms>& arms, double dt) noexcept {
  ProbeStop stop = ProbeStop::time;
  for (std::size_t i = 0; i < loop_->arms(); ++i) {
    if (arms[i].fault != Fault::none || !arms[i].q.allFinite()) {
      end_watch(ProbeStop::fault, 0);
      return;
    }
    const double x = loop_->frame(i).displacement(arms[i].q)[axis_];
    if (!has_last_ || dt <= 0.0) continue;
    // A count more or less is no speed.
    const double moved = std::abs(x - last_x_[i]);
    const double speed = std::max(moved - loop_->frame(i).quantum_m(axis_), 0.0) / dt;
    outcome_.peak_speed_m_per_s = std::max(outcome_.peak_speed_m_per_s, speed);
    // Where it will be before anything can brake it.
    const double ahead = std::copysign(speed * kLookAhead_s, x - last_x_[i]);
    if (std::abs(x + ahead) > kStopShare * config_.bounds.travel_m) stop = ProbeStop::travel;
    if (speed > kStopShare * config_.bounds.speed_m_per_s) stop = ProbeStop::speed;
    work_J_ += last_force_[i] * (x - last_x_[i]);
    outcome_.energy_J = std::max(outcome_.energy_J, work_J_);
    if (work_J_ > kStopShare * config_.bounds.energy_J) stop = ProbeStop::energy;
  }
  if (stop == ProbeStop::time) return;
  if (phase_ == Phase::push || phase_ == Phase::watch) {
    end_watch(stop, 0);
  } else {
    fall_back();
  }
}

/// Less law, where the law is what keeps the arm moving.
void Probe::fall_back() noexcept {
  // A bound stays broken for a while after the gain has changed.
  const bool is_new = on_level_ * config_.period_s < kRest_s;
  if (is_new || outcome_.fallbacks == 2) return;
  outcome_.swelled = true;
  ++outcome_.fallbacks;
  on_level_ = 0;
}

void Probe::end_watch(ProbeStop stop, int ticks_to_safe) noexcept {
  const bool watching = phase_ != Phase::recover && phase_ != Phase::done;
  if (watching || stop == ProbeStop::fault) outcome_.stop = stop;
  outcome_.ticks_to_safe = ticks_to_safe;
  go(stop == ProbeStop::fault ? Phase::done : Phase::recover);
}

void Probe::remember(const LoopUnderTest::Turn& turn) noexcept {
  if (trace_.size >= trace_.t_s.size()) return;
  trace_.t_s[trace_.size] = time_s_;
  for (std::size_t i = 0; i < loop_->arms(); ++i) {
    trace_.displacement[i][trace_.size] = turn.displacement[i];
  }
  ++trace_.size;
}

/// Whether there is room for a push.
bool Probe::is_near() const noexcept {
  constexpr double kNear = 0.25;
  const auto near = [&](double x) {
    return std::abs(x) < kNear * config_.bounds.travel_m;
  };
  return std::all_of(last_x_.begin(), last_x_.end(), near);
}

bool Probe::rests() noexcept {
  const auto window = static_cast<std::size_t>(
      std::min(rest_window_s() / config_.period_s / stride_, static_cast<double>(kWindow)));
  if (filled_ < window) return false;
  outcome_.rest_peak_m = amplitude(window);
  double quantum = 0.0;
  for (std::size_t i = 0; i < loop_->arms(); ++i) {
    quantum = std::max(quantum, loop_->frame(i).quantum_m(axis_));
  }
  return 2.0 * outcome_.rest_peak_m <= kRestCounts * quantum;
}

void Probe::advance_watch(const LoopUnderTest::Turn& turn) noexcept {
  remember(turn);
  const auto window = static_cast<std::size_t>(
      std::clamp(plan_.period_s / config_.period_s / stride_, 4.0, double{kWindow}));
  const double swing = amplitude(window);
  ++outcome_.watch_ticks;
  outcome_.peak_swing_m = std::max(outcome_.peak_swing_m, swing);
  const double floor = std::max(plan_.floor_m, kFloorShare * outcome_.peak_swing_m);
  small_for_ = filled_ >= window && swing < floor ? small_for_ + 1 : 0;
  if (turn.cut) {
    end_watch(ProbeStop::force, 1);
  } else if (swing > plan_.ceiling_m) {
    end_watch(ProbeStop::grew, 1);
  } else if (small_for_ * config_.period_s > plan_.memory_s) {
    end_watch(ProbeStop::decayed, 1);
  } else if (in_phase_ * config_.period_s >= plan_.watch_s) {
    end_watch(ProbeStop::time, 1);
  }
}

/// What follows from this tick for the next.
void Probe::advance(const LoopUnderTest::Turn& turn) noexcept {
  const double in_phase_s = in_phase_ * config_.period_s;
  const bool calms = phase_ == Phase::settle || phase_ == Phase::recover;
  const bool swells = calms && amplitude(kWindow) > 2.0 * plan_.ceiling_m;
  if (swells) fall_back();
  const bool lasts = calms && outcome_.fallbacks == 0 && in_phase_s > kPatience_s;
  if (lasts) outcome_.fallbacks = 1;
  switch (phase_) {
    case Phase::settle:
      if (rests() && is_near()) {
        go(Phase::push);
      } else if (in_phase_s > config_.longest_rest_s) {
        end_watch(ProbeStop::restless, 1);
      }
      break;
    case Phase::push:
      if (turn.cut) {
        end_watch(ProbeStop::force, 1);
      } else if (in_phase_ >= plan_.push_ticks) {
        go(Phase::watch);
      }
      break;
    case Phase::watch:
      advance_watch(turn);
      break;
    case Phase::recover:
      outcome_.rests = rests();
      if (outcome_.rests || in_phase_s > config_.longest_rest_s) phase_ = Phase::done;
      break;
    case Phase::done:
      break;
  }
}

LoopUnderTest::Command Probe::command() const noexcept {
  const bool tried = phase_ == Phase::push || phase_ == Phase::watch;
  return {.gain = tried ? plan_.gain : (outcome_.fallbacks > 0 ? 0.0 : plan_.safe_gain),
          .push_N = phase_ == Phase::push ? plan_.push_N : 0.0,
          .hold_axis = !tried && outcome_.fallbacks < 2,
          .most_force_N = config_.bounds.force_N};
}

LoopUnderTest::Turn Probe::step(const std::array<ArmState, kMostArms>& arms, double dt) noexcept {
  ++outcome_.ticks;
  ++in_phase_;
  ++on_level_;
  if (abandoned_ && phase_ != Phase::recover) end_watch(ProbeStop::abandoned, 0);
  look_at_bounds(arms, dt);
  if (outcome_.stop == ProbeStop::fault) return {};
  const LoopUnderTest::Turn turn = loop_->step(arms, command(), dt);
  measure(turn, dt);
  advance(turn);
  return turn;
}

LoopUnderTest::Turn Probe::idle(const std::array<ArmState, kMostArms>& arms, double dt) noexcept {
  time_s_ += dt;
  return loop_->step(
      arms, {.gain = plan_.safe_gain, .hold_axis = true, .most_force_N = config_.bounds.force_N},
      dt);
}

}  // namespace teleop
