#include "core/reporting/side_metrics.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

/// Silence at the very end of a log is the other side closing down, unless it lasts longer.
constexpr double kClosing = 0.5;  // s

const FaultText* text_of(int code) {
  for (const FaultText& row : fault_table()) {
    if (row.code == code) return &row;
  }
  return nullptr;
}

/// Root mean square and peak of a magnitude, of what is finite.
class Magnitude {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    sum_ += value * value;
    count_ += 1.0;
    peak_ = std::max(peak_, value);
  }
  [[nodiscard]] double rms() const { return count_ > 0.0 ? std::sqrt(sum_ / count_) : 0.0; }
  [[nodiscard]] double peak() const { return peak_; }

 private:
  double sum_ = 0.0;
  double count_ = 0.0;
  double peak_ = 0.0;
};

void measure_turns(const Log& log, const Samples& samples, SideMetrics& out) {
  const TickRecord& first = log.ticks.front();
  const TickRecord& last = log.ticks.back();
  const auto recorded = static_cast<std::uint64_t>(log.ticks.size());
  out.ticks = std::max(last.tick - first.tick + 1, recorded);
  out.dropped_records = out.ticks - recorded;
  out.seconds = 1e-9 * static_cast<double>(last.stamp_ns - first.stamp_ns);
  out.nominal_rate_Hz = nominal_rate(log);
  if (out.seconds > 0.0) {
    out.rate_Hz = static_cast<double>(out.ticks - 1) / out.seconds;
    const double fitting = std::round(out.seconds * out.nominal_rate_Hz) + 1.0;
    // Above 1 only by the jitter of the first and the last stamp.
    out.tick_share = std::min(static_cast<double>(out.ticks) / fitting, 1.0);
  }
  const double late_us = 0.1e6 / out.nominal_rate_Hz;
  out.late_turns = static_cast<std::uint64_t>(
      std::count_if(samples.lateness_us.begin(), samples.lateness_us.end(),
                    [late_us](double lateness) { return lateness > late_us; }));
  out.packets = {.sent = last.packets_sent,
                 .received = last.packets_received,
                 .lost = last.packets_lost,
                 .duplicated = last.packets_duplicated,
                 .reordered = last.packets_reordered};
}

void measure_coupling(const Log& log, SideMetrics& out) {
  Magnitude engaged_force;
  Magnitude force;
  Magnitude error;
  std::uint64_t engaged = 0;
  std::uint32_t epoch = 0;
  for (const TickRecord& record : log.ticks) {
    force.add(record.coupling_N.norm());
    if (mode_of(record) != Mode::engaged) continue;
    engaged_force.add(record.coupling_N.norm());
    error.add(1e3 * record.error_m.norm());
    if (engaged == 0 || record.epoch != epoch) ++out.engagements;
    epoch = record.epoch;
    ++engaged;
  }
  out.engaged_share = static_cast<double>(engaged) / static_cast<double>(log.ticks.size());
  out.coupling_rms_N = engaged_force.rms();
  out.coupling_peak_N = force.peak();
  out.law_error_rms_mm = error.rms();
  out.law_error_peak_mm = error.peak();
  out.coupling_energy_J = log.ticks.back().energy_J;
}

void measure_port(const Log& log, SideMetrics& out) {
  Magnitude force;
  double energy = 0.0;
  double last_power = 0.0;
  const TickRecord* last = nullptr;
  for (const TickRecord& record : log.ticks) {
    const double power = record.tool_force_N.dot(record.v_m_per_s);
    if (!has(record, ArmFlag::has_tool_force) || !std::isfinite(power)) {
      last = nullptr;
      continue;
    }
    force.add(record.tool_force_N.norm());
    if (last != nullptr) {
      const double dt = 1e-9 * static_cast<double>(record.stamp_ns - last->stamp_ns);
      energy += 0.5 * (last_power + power) * dt;
    }
    last = &record;
    last_power = power;
    out.tool_force_peak_N = force.peak();
    out.port_energy_J = energy;
  }
}

void list_limits(const Log& log, SideMetrics& out) {
  for (const FaultText& row : fault_table()) {
    if (row.code < 100) continue;
    const auto limit = static_cast<Limit>(row.code - 100);
    const auto ticks = static_cast<std::uint64_t>(
        std::count_if(log.ticks.begin(), log.ticks.end(),
                      [limit](const TickRecord& record) { return has(record, limit); }));
    if (limit == Limit::overrun) out.overruns = ticks;
    if (ticks == 0) continue;
    out.limits.push_back(
        {.side = out.role, .ticks = ticks, .code = row.code, .name = row.name, .cause = row.cause});
  }
}

void list_faults(const Side& side, SideMetrics& out) {
  std::uint32_t last = 0;
  for (const TickRecord& record : side.log->ticks) {
    if (record.fault != last && record.fault != 0) {
      const int code = static_cast<int>(record.fault);
      const FaultText* text = text_of(code);
      out.faults.push_back(
          {.side = out.role,
           .t_s = side.clock.seconds(record.stamp_ns),
           .code = code,
           .name = text == nullptr ? "unknown" : text->name,
           .cause = text == nullptr ? "a fault that this version does not know" : text->cause});
    }
    last = record.fault;
  }
}

void list_outages(const Side& side, SideMetrics& out) {
  bool peer_seen = false;
  bool silent = false;
  const auto end_with = [&](const TickRecord& record, bool ended) {
    Outage& outage = out.outages.back();
    outage.length_s = side.clock.seconds(record.stamp_ns) - outage.t_s;
    outage.ended = ended;
  };
  for (const TickRecord& record : side.log->ticks) {
    // Until the first echo nothing bounds the age of what came: that is no silence yet.
    const bool silent_now = has(record, Limit::peer_silent);
    peer_seen = peer_seen || (record.peer_session != 0 && !silent_now);
    const bool now = peer_seen && silent_now;
    if (now && !silent) {
      // The limit comes on a timeout after the last packet, with which the silence began.
      const bool told = 0 < record.peer_received_ns && record.peer_received_ns < record.stamp_ns;
      const std::int64_t begin_ns = told ? record.peer_received_ns : record.stamp_ns;
      out.outages.push_back(
          {.side = out.role, .t_s = side.clock.seconds(begin_ns), .ended = false});
    }
    if (!now && silent) end_with(record, true);
    silent = now;
  }
  if (!silent) return;
  end_with(side.log->ticks.back(), false);
  if (out.outages.back().length_s < kClosing) out.outages.pop_back();
}

}  // namespace

Packets& Packets::operator+=(const Packets& other) noexcept {
  sent += other.sent;
  received += other.received;
  lost += other.lost;
  duplicated += other.duplicated;
  reordered += other.reordered;
  return *this;
}

void Samples::append(const Samples& other) {
  const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(lateness_us, other.lateness_us);
  add(compute_us, other.compute_us);
  add(round_trip_us, other.round_trip_us);
  add(age_ms, other.age_ms);
}

Samples samples_of(const Log& log) {
  Samples samples;
  samples.lateness_us.reserve(log.ticks.size());
  samples.compute_us.reserve(log.ticks.size());
  const TickRecord* last = nullptr;
  for (const TickRecord& record : log.ticks) {
    samples.lateness_us.push_back(record.lateness_us);
    samples.compute_us.push_back(record.compute_us);
    const bool arrived = last == nullptr || record.peer_sequence != last->peer_sequence ||
                         record.peer_session != last->peer_session;
    if (arrived && record.round_trip_us > 0.0) {
      samples.round_trip_us.push_back(record.round_trip_us);
    }
    const Mode mode = mode_of(record);
    const bool coupled = mode == Mode::engaging || mode == Mode::engaged;
    if (coupled && record.peer_session != 0) samples.age_ms.push_back(record.peer_age_ms);
    last = &record;
  }
  return samples;
}

SideMetrics side_metrics(const Side& side, const Samples& samples) {
  const Log& log = *side.log;
  if (log.ticks.empty()) {
    throw RecordingError{
        fmt::format("{}: holds no turn of a loop; record a run first", log.file.string())};
  }
  SideMetrics out;
  out.role = role_of(log);
  out.file = log.file.string();
  if (!log.complete) out.damage = log.damage.empty() ? "cut off" : log.damage;
  out.begin_s = side.clock.seconds(log.ticks.front().stamp_ns);
  out.lateness_us = distribution(samples.lateness_us);
  out.compute_us = distribution(samples.compute_us);
  out.round_trip_us = distribution(samples.round_trip_us);
  out.age_ms = distribution(samples.age_ms);
  measure_turns(log, samples, out);
  measure_coupling(log, out);
  measure_port(log, out);
  list_limits(log, out);
  list_faults(side, out);
  list_outages(side, out);
  return out;
}

}  // namespace teleop
