#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/reporting/tick.hpp"

namespace teleop::testing {

/// How to make up the log of one side.
struct LogOf {
  Role role = Role::master;
  double seconds = 2.0;
  double rate_Hz = 1000.0;
  std::int64_t begin_ns = 5'000'000'000;
  std::function<Vector3(double)> position = [](double) {
    return Vector3{Vector3::Zero()};
  };
  std::function<void(TickRecord&, double)> change = [](TickRecord&, double) {
  };
};

/// A side that is engaged from its first turn to its last. Times are those of its own clock.
inline Log log_of(const LogOf& of) {
  Log log;
  log.file = std::string{name_of(of.role)} + ".mcap";
  log.metadata = {{"role", name_of(of.role)}, {"rate_Hz", std::to_string(of.rate_Hz)}};
  const auto turns = static_cast<std::uint64_t>(std::llround(of.seconds * of.rate_Hz));
  for (std::uint64_t i = 0; i <= turns; ++i) {
    const double since_s = static_cast<double>(i) / of.rate_Hz;
    TickRecord record;
    record.tick = i;
    record.stamp_ns = of.begin_ns + std::llround(1e9 * since_s);
    record.elapsed_ms = 1e3 / of.rate_Hz;
    record.mode = static_cast<std::uint32_t>(Mode::engaged);
    record.epoch = 1;
    record.ramp = 1.0;
    record.peer_session = 7;
    record.peer_sequence = i + 1;
    record.p_m = of.position(1e-9 * static_cast<double>(record.stamp_ns));
    record.packets_sent = i + 1;
    record.packets_received = i + 1;
    of.change(record, since_s);
    log.ticks.push_back(record);
  }
  return log;
}

/// a sin(2 π f (t − lag)) along x.
inline std::function<Vector3(double)> sine(double amplitude_m, double f_Hz, double lag_s = 0.0) {
  return [=](double t_s) {
    return Vector3{amplitude_m * std::sin(2.0 * std::numbers::pi * f_Hz * (t_s - lag_s)), 0.0, 0.0};
  };
}

/// The value of what must be there: an exception fails the test that asks.
template <class Value>
const Value& there(const std::optional<Value>& value) {
  if (!value) throw std::logic_error{"absent"};
  return *value;
}

inline void set(TickRecord& record, Limit limit) {
  record.limits |= 1U << static_cast<unsigned>(limit);
}

inline void set(TickRecord& record, Mode mode) { record.mode = static_cast<std::uint32_t>(mode); }

inline void set_tool_force(TickRecord& record, const Vector3& force) {
  record.arm_flags |= static_cast<std::uint32_t>(ArmFlag::has_tool_force);
  record.tool_force_N = force;
}

}  // namespace teleop::testing
