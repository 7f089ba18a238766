#include "core/experiment/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

/// Of an encoder at rest.
constexpr int kJitter_counts = 2;
constexpr double kStill_s = 1.0;

bool asked(const std::atomic<bool>* stop) noexcept {
  return stop != nullptr && stop->load(std::memory_order_relaxed);
}

/// What the workers of one sweep share.
struct Shared {
  const SweepPlan& plan;
  SweepStore& store;
  const SweepControl& control;
  std::vector<std::size_t> missing;
  std::size_t total = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> ended{false};  ///< asked for from outside, or an error
  std::mutex mutex{};              ///< of the store, the error and the progress
  std::exception_ptr error{};
};

void work(Shared& shared) {
  try {
    while (!shared.ended) {
      const std::size_t turn = shared.next++;
      if (turn >= shared.missing.size()) return;
      const std::size_t index = shared.missing[turn];
      const Scenario scenario{shared.plan.text(), shared.plan.overrides(index)};
      ExperimentContext context;
      context.stop = shared.control.stop;
      const Results results = scenario.run(context);
      if (asked(shared.control.stop)) return;  // it may have ended before its time
      const std::lock_guard lock{shared.mutex};
      shared.store.add(index, results);
      if (shared.control.progress) {
        shared.control.progress(shared.store.lines().size(), shared.total);
      }
    }
  } catch (...) {
    shared.ended = true;
    const std::lock_guard lock{shared.mutex};
    if (!shared.error) shared.error = std::current_exception();
  }
}

}  // namespace

bool run_sweep(const SweepPlan& plan,
               SweepStore& store,
               unsigned jobs,
               const SweepControl& control) {
  Shared shared{.plan = plan, .store = store, .control = control, .missing = store.missing()};
  shared.total = store.lines().size() + shared.missing.size();
  const std::size_t workers = std::min<std::size_t>(std::max(jobs, 1U), shared.missing.size());
  std::vector<std::thread> threads;
  threads.reserve(workers);
  for (std::size_t i = 0; i < workers; ++i) {
    threads.emplace_back([&shared] { work(shared); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  if (shared.error) std::rethrow_exception(shared.error);
  const bool complete = store.missing().empty();
  if (complete) store.sort();
  return complete;
}

bool run_sweep_on_arm(const SweepPlan& plan,
                      SweepStore& store,
                      const OpenArm& arm,
                      const SweepControl& control) {
  const std::vector<std::size_t> missing = store.missing();
  const std::size_t total = store.lines().size() + missing.size();
  for (const std::size_t index : missing) {
    const Scenario scenario{plan.text(), plan.overrides(index)};
    const bool rests = arm.arm.info().simulated || wait_for_rest(arm, plan.rest(), control.stop);
    if (!rests) return false;
    ExperimentContext context;
    context.arm = &arm;
    context.stop = control.stop;
    const Results results = scenario.run(context);
    if (asked(control.stop)) return false;
    store.add(index, results);
    if (control.progress) control.progress(store.lines().size(), total);
    if (has_fault(results)) return false;
  }
  store.sort();
  return true;
}

bool wait_for_rest(const OpenArm& arm, const SweepRest& rest, const std::atomic<bool>* stop) {
  const Instant begin = arm.clock.now();
  Instant still_since = begin;
  ArmState before = arm.arm.read();
  while (!asked(stop)) {
    arm.clock.sleep_until(arm.clock.now() + std::chrono::milliseconds{20});
    const ArmState state = arm.arm.read();
    const Instant now = arm.clock.now();
    if (state.fault != Fault::none) {
      throw DeviceError{fmt::format("{}: {} between two points; look at the arm, then run again",
                                    arm.arm.info().name, name_of(state.fault))};
    }
    for (std::size_t i = 0; i < kJoints; ++i) {
      if (std::abs(state.counts.at(i) - before.counts.at(i)) > kJitter_counts) {
        before = state;
        still_since = now;
      }
    }
    const bool tells = state.has(ArmFlag::has_temperatures);
    const double waited_s = seconds(now - begin);
    const bool still = seconds(now - still_since) >= kStill_s;
    const bool cool = tells ? state.motor_temperature.maxCoeff() <= rest.max_temperature_C
                            : waited_s >= rest.pause_s;
    if (still && cool) return true;
    if (waited_s > rest.timeout_s) {
      const std::string state_now =
          still ? fmt::format("above {:.0f} C", rest.max_temperature_C) : "in motion";
      throw DeviceError{fmt::format("{}: still {} after {:.0f} s; look at the arm, then run again",
                                    arm.arm.info().name, state_now, waited_s)};
    }
  }
  return false;
}

}  // namespace teleop
