#include "core/reporting/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"
#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

double end_of(const Side& side) { return side.clock.seconds(side.log->ticks.back().stamp_ns); }
double begin_of(const Side& side) { return side.clock.seconds(side.log->ticks.front().stamp_ns); }

std::optional<Tracking> tracking_of(std::span<const PairedTick> pairs, double rate_Hz) {
  if (pairs.empty()) return {};
  double sum = 0.0;
  double peak = 0.0;
  for (const PairedTick& pair : pairs) {
    sum += pair.error.squaredNorm();
    peak = std::max(peak, pair.error.norm());
  }
  const auto count = static_cast<double>(pairs.size());
  return Tracking{.rms_mm = 1e3 * std::sqrt(sum / count),
                  .peak_mm = 1e3 * peak,
                  .seconds = rate_Hz > 0.0 ? count / rate_Hz : 0.0};
}

/// The earliest turn is 0 s; of each side its own where their clocks cannot be compared.
void set_begin(Run& run) {
  const bool together = run.master && run.slave && !run.slave->clock.unknown();
  double earliest = std::numeric_limits<double>::infinity();
  for (const Side* side : run.sides()) {
    earliest = std::min(earliest, begin_of(*side));
  }
  for (std::optional<Side>* side : {&run.master, &run.slave}) {
    if (!side->has_value()) continue;
    Side& there = side->value();
    there.clock.begin_at(std::llround(1e9 * (together ? earliest : begin_of(there))));
    run.seconds = std::max(run.seconds, end_of(there));
  }
}

template <class Row>
void append(std::vector<Row>& to, const std::vector<Row>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <class Row>
void sort_by_time(std::vector<Row>& rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.t_s < b.t_s; });
}

void add_pair(const Side& master, const Side& slave, PairMetrics& out) {
  const std::vector<PairedTick> pairs = pair_ticks(master, slave);
  out.clocks_unknown = slave.clock.unknown();
  out.clock_error_bound_us = slave.clock.error_bound_us();
  out.tracking = tracking_of(pairs, nominal_rate(*master.log));
  out.rest_contact = contact_at_rest(*master.log, *slave.log, pairs);
  const double begin = std::max(begin_of(master), begin_of(slave));
  const double end = std::min(end_of(master), end_of(slave));
  out.overlap_s = std::max(end - begin, 0.0);
  const auto& ticks = master.log->ticks;
  const auto turns = std::count_if(ticks.begin(), ticks.end(), [&](const TickRecord& record) {
    const double t_s = master.clock.seconds(record.stamp_ns);
    return begin <= t_s && t_s <= end;
  });
  out.engaged_share =
      turns > 0 ? static_cast<double>(pairs.size()) / static_cast<double>(turns) : 0.0;
}

template <class Item>
std::vector<const Item*> those_of(const std::optional<Item>& master,
                                  const std::optional<Item>& slave) {
  std::vector<const Item*> out;
  if (master) out.push_back(&*master);
  if (slave) out.push_back(&*slave);
  return out;
}

}  // namespace

std::vector<const Side*> Run::sides() const { return those_of(master, slave); }

std::vector<const SideMetrics*> PairMetrics::sides() const { return those_of(master, slave); }

const SideMetrics& PairMetrics::first() const {
  const std::vector<const SideMetrics*> there = sides();
  expects(!there.empty(), "metrics are of one side at least");
  return *there.front();
}

Run arrange(std::span<const Log> logs) {
  if (logs.empty() || logs.size() > 2) {
    throw RecordingError{fmt::format("{} logs: give one, or one of each side", logs.size())};
  }
  Run run;
  for (const Log& log : logs) {
    const Role role = role_of(log);
    if (log.ticks.empty()) {
      throw RecordingError{
          fmt::format("{}: holds no turn of a loop; record a run first", log.file.string())};
    }
    std::optional<Side>& side = role == Role::master ? run.master : run.slave;
    if (side) {
      throw RecordingError{fmt::format("{} and {}: both are of the {}; give one of each side",
                                       side->log->file.string(), log.file.string(), name_of(role))};
    }
    side = Side{.log = &log};
  }
  if (run.master && run.slave) {
    run.slave->clock = RunClock::of_slave(*run.master->log, *run.slave->log);
  }
  set_begin(run);
  return run;
}

PairMetrics measure(std::span<const Log> logs) {
  const Run run = arrange(logs);
  PairMetrics out;
  out.seconds = run.seconds;
  Samples pooled;
  for (const Side* side : run.sides()) {
    const Samples samples = samples_of(*side->log);
    const SideMetrics metrics = side_metrics(*side, samples);
    pooled.append(samples);
    out.packets += metrics.packets;
    append(out.faults, metrics.faults);
    append(out.outages, metrics.outages);
    append(out.limits, metrics.limits);
    out.overlap_s = metrics.seconds;
    out.engaged_share = metrics.engaged_share;
    (metrics.role == Role::master ? out.master : out.slave) = metrics;
  }
  sort_by_time(out.faults);
  sort_by_time(out.outages);
  if (run.master && run.slave) add_pair(*run.master, *run.slave, out);
  out.lateness_us = distribution(std::move(pooled.lateness_us));
  out.compute_us = distribution(std::move(pooled.compute_us));
  out.round_trip_us = distribution(std::move(pooled.round_trip_us));
  out.age_ms = distribution(std::move(pooled.age_ms));
  return out;
}

}  // namespace teleop
