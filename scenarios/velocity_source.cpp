#include "scenarios/velocity_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/estimation/smoother.hpp"
#include "core/model/kinematics.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/recording/log.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

constexpr double kShortest_s = 1.0;

JointVector counts_per_rev(const ArmModel& arm) {
  const std::array<double, 3>& counts = arm.parameters().encoder_counts_per_rev;
  return {counts[0], counts[1], counts[2]};
}

/// A simulated arm, moved by its hand, motors off.
VelocitySource simulate(const VelocityOptions& options) {
  SimulatedClock clock;
  const auto arm =
      open_device(options.device, {.clock = clock, .hand = options.hand, .seed = options.seed});
  auto* const simulated = dynamic_cast<SimulatedArm*>(arm.get());
  if (simulated == nullptr) {
    throw ConfigError{fmt::format(
        "--device {}: only of a simulated arm is the truth known; record another one with "
        "teleop-master and give the recording",
        options.device)};
  }
  VelocitySource source{.arm = simulated->model(), .has_truth = true, .has_period = true};
  VelocityTrace trace{
      .source = fmt::format("{}, hand {}, seed {}", options.device, options.hand, options.seed),
      .counts_per_rev = arm->info().counts_per_rev};
  const Instant start = clock.now();
  const Duration period{static_cast<std::int64_t>(std::llround(1e9 / options.rate_Hz))};
  const auto turns = static_cast<std::int64_t>(options.seconds * options.rate_Hz);
  for (std::int64_t k = 0; k < turns; ++k) {
    clock.sleep_until(start + k * period);
    const ArmState state = arm->read();
    const SimulatedArm::Truth truth = simulated->true_state();
    trace.samples.push_back(
        {.q = state.q, .period_ticks = state.period_ticks, .dt = seconds(period)});
    trace.time_s.push_back(static_cast<double>(k) * seconds(period));
    trace.J.push_back(linear_jacobian(source.arm, state.q));
    trace.v.push_back(truth.v_BT);
  }
  source.traces.push_back(std::move(trace));
  return source;
}

/// A recording; its reference is its own positions, smoothed without phase.
VelocityTrace trace_of(const Log& log, const ArmModel& arm, double reference_Hz) {
  VelocityTrace trace{.source = log.file.string(), .counts_per_rev = counts_per_rev(arm)};
  std::vector<JointVector> q;
  const TickRecord* before = nullptr;
  for (const TickRecord& tick : log.ticks) {
    if (!tick.q_rad.allFinite()) continue;
    // What a live loop has measured, unless ticks between are missing.
    const bool follows = before == nullptr || tick.tick == before->tick + 1;
    const double dt = follows ? 1e-3 * tick.elapsed_ms
                              : 1e-9 * static_cast<double>(tick.stamp_ns - before->stamp_ns);
    if (before != nullptr && dt <= 0.0) continue;
    trace.samples.push_back({.q = tick.q_rad, .period_ticks = tick.period_ticks, .dt = dt});
    trace.time_s.push_back(before == nullptr ? 0.0 : trace.time_s.back() + dt);
    trace.J.push_back(linear_jacobian(arm, tick.q_rad));
    q.push_back(tick.q_rad);
    before = &tick;
  }
  if (trace.time_s.empty() || trace.time_s.back() < kShortest_s) {
    throw ConfigError{fmt::format("{}: shorter than {:.0f} s of readings: record a longer one",
                                  log.file.string(), kShortest_s)};
  }
  const auto qd = zero_phase_velocity(trace.time_s, q, reference_Hz);
  for (std::size_t k = 0; k < qd.size(); ++k) {
    trace.v.emplace_back(trace.J[k] * qd[k]);
  }
  trace.skip_end_s = zero_phase_margin_s(reference_Hz);
  trace.skip_s = std::max(trace.skip_s, trace.skip_end_s);
  return trace;
}

std::string arm_of(const Log& log, const std::string& wanted) {
  if (!wanted.empty()) return wanted;
  const auto named = log.metadata.find("arm");
  if (named != log.metadata.end() && !named->second.empty()) return named->second;
  throw ConfigError{
      fmt::format("{}: does not say which arm it is of: give --arm", log.file.string())};
}

bool has_period(const TickRecord& tick) {
  return (tick.arm_flags & static_cast<std::uint32_t>(ArmFlag::has_period)) != 0;
}

}  // namespace

VelocitySource load_velocity_source(const VelocityOptions& options) {
  if (options.logs.empty()) return simulate(options);
  std::string arm;
  std::unique_ptr<VelocitySource> source;
  for (const std::string& file : options.logs) {
    const Log log = read_log(file);
    const std::string own = arm_of(log, options.arm);
    if (!source) {
      arm = own;
      source = std::make_unique<VelocitySource>(
          VelocitySource{.arm = load_arm(arm), .has_period = true});
    }
    if (own != arm) {
      throw ConfigError{fmt::format(
          "{}: is of arm '{}', the first recording of '{}': look at them apart", file, own, arm)};
    }
    source->traces.push_back(trace_of(log, source->arm, options.reference_Hz));
    source->has_period =
        source->has_period && std::all_of(log.ticks.begin(), log.ticks.end(), has_period);
  }
  return std::move(*source);
}

}  // namespace teleop
