#include "scenarios/velocity_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/estimation/smoother.hpp"
#include "core/model/kinematics.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/realtime/loop.hpp"
#include "core/recording/log.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

constexpr double kShortest_s = 1.0;

JointVector counts_per_rev(const ArmModel& arm) {
  const std::array<double, 3>& counts = arm.parameters().encoder_counts_per_rev;
  return {counts[0], counts[1], counts[2]};
}

/// The reference where there is no truth: the positions' own slope, smoothed without phase.
void set_reference(VelocityTrace& trace, double reference_Hz) {
  std::vector<JointVector> q;
  q.reserve(trace.samples.size());
  for (const VelocitySample& sample : trace.samples) {
    q.push_back(sample.q);
  }
  const auto qd = zero_phase_velocity(trace.time_s, q, reference_Hz);
  for (std::size_t k = 0; k < qd.size(); ++k) {
    trace.v.emplace_back(trace.J[k] * qd[k]);
  }
  trace.skip_end_s = zero_phase_margin_s(reference_Hz);
  trace.skip_s = std::max(trace.skip_s, trace.skip_end_s);
}

void append(VelocityTrace& trace, const ArmModel& arm, const VelocitySample& sample) {
  trace.time_s.push_back(trace.time_s.empty() ? 0.0 : trace.time_s.back() + sample.dt);
  trace.J.push_back(linear_jacobian(arm, sample.q));
  trace.samples.push_back(sample);
}

/// An arm read through its port, motors off, on whatever clock it lives on.
VelocitySource read_arm(const VelocityOptions& options, Clock& clock) {
  struct Reading {
    VelocitySample sample{};
    Vector3 v = Vector3::Zero();
  };
  const auto arm =
      open_device(options.device, {.clock = clock, .hand = options.hand, .seed = options.seed});
  auto* const simulated = dynamic_cast<SimulatedArm*>(arm.get());
  std::vector<Reading> readings(static_cast<std::size_t>(options.seconds * options.rate_Hz));
  std::size_t turn = 0;
  ArmState state;
  const Duration period{static_cast<std::int64_t>(std::llround(1e9 / options.rate_Hz))};
  run_periodically(clock, period, [&](const Tick& tick) noexcept {
    state = arm->read();
    readings[turn].sample = {
        .q = state.q, .period_ticks = state.period_ticks, .dt = seconds(tick.elapsed)};
    if (simulated != nullptr) readings[turn].v = simulated->true_state().v_BT;
    ++turn;
    return turn < readings.size() && state.fault == Fault::none ? Next::again : Next::stop;
  });
  if (state.fault != Fault::none) {
    throw DeviceError{fmt::format("--device {}: stopped after {} readings: {}", options.device,
                                  turn, name_of(state.fault))};
  }
  VelocitySource source{.arm = load_arm(arm->info().model),
                        .has_truth = simulated != nullptr,
                        .has_period = state.has(ArmFlag::has_period)};
  VelocityTrace trace{.source = simulated == nullptr
                                    ? options.device
                                    : fmt::format("{}, hand {}, seed {}", options.device,
                                                  options.hand, options.seed),
                      .counts_per_rev = arm->info().counts_per_rev};
  for (const Reading& reading : readings) {
    append(trace, source.arm, reading.sample);
    if (source.has_truth) trace.v.push_back(reading.v);
  }
  if (!source.has_truth) set_reference(trace, options.reference_Hz);
  source.traces.push_back(std::move(trace));
  return source;
}

/// Simulated arms live on simulated time unless they are asked not to.
VelocitySource read_arm(const VelocityOptions& options) {
  const bool simulated = options.device.substr(0, options.device.find(':')) == "sim";
  if (simulated && !options.real_time) {
    SimulatedClock clock;
    return read_arm(options, clock);
  }
  SystemClock clock;
  return read_arm(options, clock);
}

/// A recording; its reference is its own positions, smoothed without phase.
VelocityTrace trace_of(const Log& log, const ArmModel& arm, double reference_Hz) {
  VelocityTrace trace{.source = log.file.string(), .counts_per_rev = counts_per_rev(arm)};
  const TickRecord* before = nullptr;
  for (const TickRecord& tick : log.ticks) {
    if (!tick.q_rad.allFinite()) continue;
    // What a live loop has measured, unless ticks between are missing.
    const bool follows = before == nullptr || tick.tick == before->tick + 1;
    const double dt = follows ? 1e-3 * tick.elapsed_ms
                              : 1e-9 * static_cast<double>(tick.stamp_ns - before->stamp_ns);
    if (before != nullptr && dt <= 0.0) continue;
    append(trace, arm, {.q = tick.q_rad, .period_ticks = tick.period_ticks, .dt = dt});
    before = &tick;
  }
  if (trace.time_s.empty() || trace.time_s.back() < kShortest_s) {
    throw ConfigError{fmt::format("{}: shorter than {:.0f} s of readings: record a longer one",
                                  log.file.string(), kShortest_s)};
  }
  set_reference(trace, reference_Hz);
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
  if (options.logs.empty()) return read_arm(options);
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
