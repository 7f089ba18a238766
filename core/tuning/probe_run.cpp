#include "core/tuning/probe_run.hpp"

#include <atomic>
#include <cmath>
#include <exception>
#include <thread>

#include "core/base/contract.hpp"
#include "core/realtime/scheduling.hpp"

namespace teleop {
namespace {

Duration period_of(const ProbeRunner::Ports& ports) {
  return Duration{static_cast<std::int64_t>(std::llround(ports.period_s * 1e9))};
}

}  // namespace

ProbeRunner::ProbeRunner(const Ports& ports, Probe& probe, LoopUnderTest& loop)
    : ports_{ports}, probe_{&probe}, next_{ports.clock->now()} {
  expects(ports.arms.size() == loop.arms(), "probe runner: one arm a frame");
  last_stamp_ = next_ - period_of(ports);
  loop.reset();
  for (Arm* arm : ports_.arms) {
    arm->amplifiers(true);
  }
}

ProbeRunner::~ProbeRunner() {
  for (Arm* arm : ports_.arms) {
    arm->write(JointVector::Zero());
    arm->amplifiers(false);
  }
}

/// One reading, one thought, one writing. The time step is that of the readings.
void ProbeRunner::turn(LoopUnderTest::Turn (Probe::*what)(const std::array<ArmState, kMostArms>&,
                                                          double) noexcept) noexcept {
  std::array<ArmState, kMostArms> states{};
  for (std::size_t i = 0; i < ports_.arms.size(); ++i) {
    states[i] = ports_.arms[i]->read();
  }
  const double dt = seconds(states[0].stamp - last_stamp_);
  last_stamp_ = states[0].stamp;
  const LoopUnderTest::Turn result = (probe_->*what)(states, dt);
  for (std::size_t i = 0; i < ports_.arms.size(); ++i) {
    ports_.arms[i]->write(result.torque_Nm[i]);
  }
}

ProbeRunner::Timing ProbeRunner::run(const ProbePlan& plan,
                                     const std::function<bool()>& stop_asked) {
  const Instant start = ports_.clock->now();
  const Duration period = period_of(ports_);
  probe_->begin(plan);
  std::uint64_t missed = 0;
  // The question is asked outside the loop's turns, between stretches of it.
  constexpr int kStretch = 50;
  while (!probe_->done()) {
    if (stop_asked && stop_asked()) probe_->abandon();
    ports_.clock->sleep_until(next_);
    int left = kStretch;
    const LoopStatistics statistics =
        run_periodically(*ports_.clock, period, [&](const Tick& tick) noexcept {
          turn(&Probe::step);
          next_ = tick.due + period;
          return probe_->done() || --left == 0 ? Next::stop : Next::again;
        });
    missed += statistics.missed;
  }
  const double used = seconds(ports_.clock->now() - start) + arm_seconds_;
  arm_seconds_ = 0.0;
  return {.missed_turns = static_cast<int>(missed), .arm_seconds = used};
}

void ProbeRunner::think_about(const std::function<void()>& thought) {
  if (ports_.time_waits) {
    thought();
    return;
  }
  const Instant start = ports_.clock->now();
  std::atomic<bool> ready{false};
  std::exception_ptr trouble;
  std::thread thinker{[&] {
    leave_realtime();
    try {
      thought();
    } catch (...) {
      trouble = std::current_exception();
    }
    ready.store(true, std::memory_order_release);
  }};
  const Duration period = period_of(ports_);
  ports_.clock->sleep_until(next_);
  run_periodically(*ports_.clock, period, [&](const Tick& tick) noexcept {
    turn(&Probe::idle);
    next_ = tick.due + period;
    return ready.load(std::memory_order_acquire) ? Next::stop : Next::again;
  });
  thinker.join();
  arm_seconds_ += seconds(ports_.clock->now() - start);
  if (trouble) std::rethrow_exception(trouble);
}

}  // namespace teleop
