#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "core/experiment/sweep_plan.hpp"
#include "core/experiment/sweep_store.hpp"

namespace teleop {

struct SweepControl {
  const std::atomic<bool>* stop = nullptr;  ///< set to end early; points begun are dropped
  /// Told after every point how many are done and how many there are; one call at a time.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Runs what the store misses, on simulated arms, `jobs` points at a time. Results do not depend on
/// `jobs`.
/// @returns whether every point has a result.
/// @throws what a point threw; the points finished until then are kept.
[[nodiscard]] bool run_sweep(const SweepPlan& plan,
                             SweepStore& store,
                             unsigned jobs,
                             const SweepControl& control);

/// The same on one arm reached through its port: one point at a time, rest before each
/// unless the arm is computed. A point
/// that ends with a fault is kept and ends the sweep, so that somebody looks before it goes on.
/// @returns whether every point has a result.
/// @throws DeviceError when the arm does not come to rest or stays too hot.
[[nodiscard]] bool run_sweep_on_arm(const SweepPlan& plan,
                                    SweepStore& store,
                                    const OpenArm& arm,
                                    const SweepControl& control);

/// Waits until an arm with its amplifiers off has stood still for a second, is as cool as asked
/// (where it tells its temperature), and the pause is over (where it does not).
/// @returns false when a stop was asked for.
/// @throws DeviceError on a fault, or when the timeout passes.
[[nodiscard]] bool wait_for_rest(const OpenArm& arm,
                                 const SweepRest& rest,
                                 const std::atomic<bool>* stop);

}  // namespace teleop
