#include "core/reporting/charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/reporting/chart_writer.hpp"
#include "core/reporting/spread.hpp"
#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostBuckets = 2000;  // two points each
constexpr std::size_t kMostFaults = 200;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double tool_power(const TickRecord& record) {
  return has(record, ArmFlag::has_tool_force) ? record.tool_force_N.dot(record.v_m_per_s) : kNone;
}

/// Sums up what flows in through the port; a state between calls, one a side.
Scalar tool_energy() {
  return [energy = 0.0, last_ns = std::int64_t{0}](const TickRecord& record) mutable {
    const double power = tool_power(record);
    const double dt = last_ns == 0 ? 0.0 : 1e-9 * static_cast<double>(record.stamp_ns - last_ns);
    last_ns = record.stamp_ns;
    if (!std::isfinite(power)) return kNone;
    energy += power * dt;
    return energy;
  };
}

void write_motion(ChartWriter& charts, std::span<const PairedTick> pairs) {
  charts.begin({"position", "Tool position", "mm", "each in the base of its own arm"});
  charts.vector([](const TickRecord& r) -> Vector3 { return 1e3 * r.p_m; });
  if (charts.sides().size() == 1) {
    const TimedSide& side = charts.sides().front();
    const Role peer = side.role == Role::master ? Role::slave : Role::master;
    const auto received = [](const TickRecord& r) -> Vector3 {
      return r.peer_session == 0 ? Vector3{Vector3::Constant(kNone)} : Vector3{1e3 * r.peer_p_m};
    };
    charts.vector(side, received, std::string{name_of(peer)} + " as received", peer);
    charts.begin(
        {"error", "Position error", "mm", "as this side saw it, age of the peer's data included"});
    charts.scalar([](const TickRecord& r) {
      return mode_of(r) == Mode::engaged ? 1e3 * r.error_m.norm() : kNone;
    });
    return;
  }
  charts.begin(
      {"error", "Tracking error", "mm", "both plants at equal times, while engaged together"});
  charts.paired("|e|", "strong", pairs, [](const Vector3& e) { return e.norm(); });
  charts.paired("x", "x", pairs, [](const Vector3& e) { return e.x(); });
  charts.paired("y", "y", pairs, [](const Vector3& e) { return e.y(); });
  charts.paired("z", "z", pairs, [](const Vector3& e) { return e.z(); });
}

void write_forces(ChartWriter& charts) {
  charts.begin({"coupling", "Coupling force", "N", "commanded at the tool"});
  charts.vector([](const TickRecord& r) { return r.coupling_N; });
  charts.begin({"tool-force", "Force on the tool", "N",
                "of the hand on the master, of the surroundings on the slave"});
  charts.vector([](const TickRecord& r) {
    return has(r, ArmFlag::has_tool_force) ? r.tool_force_N : Vector3{Vector3::Constant(kNone)};
  });
  charts.begin(
      {"power", "Power into the tool", "W", "solid: hand or surroundings, dashed: coupling"});
  charts.scalar(tool_power, " port");
  charts.scalar([](const TickRecord& r) { return r.coupling_N.dot(r.v_m_per_s); }, " coupling",
                true);
  charts.begin({"energy", "Energy into the tool", "J", "since the start of the log"});
  for (const TimedSide& side : charts.sides()) {
    charts.series(std::string{name_of(side.role)} + " port", name_of(side.role), false,
                  charts.sampled(side, tool_energy()));
  }
  charts.scalar([](const TickRecord& r) { return r.energy_J; }, " coupling", true);
}

void write_timing(ChartWriter& charts) {
  charts.begin({"lateness", "Lateness of the turns", "µs", "began so much after their time"});
  charts.scalar([](const TickRecord& r) { return r.lateness_us; });
  charts.begin({"round-trip", "Round trip", "µs", "of the network, without the peer's hold"});
  charts.scalar(
      [](const TickRecord& r) { return r.round_trip_us > 0.0 ? r.round_trip_us : kNone; });
  charts.begin({"age", "Age of the peer's state", "ms", "solid: estimated, dashed: upper bound"});
  charts.scalar([](const TickRecord& r) { return r.peer_session == 0 ? kNone : r.peer_age_ms; });
  charts.scalar(
      [](const TickRecord& r) { return r.peer_session == 0 ? kNone : r.peer_age_bound_ms; },
      " bound", true);
}

/// Stretches of buckets with one value: [first, last, value] …
template <class Merge>
Json runs_of(const TimedSide& side, const TimeGrid& grid, std::uint32_t none, Merge&& merge) {
  std::vector<std::uint32_t> values(grid.buckets, none);
  for (std::size_t i = 0; i < side.t_s.size(); ++i) {
    if (const auto bucket = grid.bucket_of(side.t_s[i])) {
      values[*bucket] = merge(values[*bucket], side.log->ticks[i]);
    }
  }
  Json runs = Json::array();
  for (std::size_t first = 0; first < values.size();) {
    std::size_t last = first;
    while (last + 1 < values.size() && values[last + 1] == values[first]) {
      ++last;
    }
    if (values[first] != none) runs.push_back({first, last, values[first]});
    first = last + 1;
  }
  return runs;
}

/// The mode that a viewer must not miss wins a bucket.
std::uint32_t graver(std::uint32_t bucket, const TickRecord& record) {
  constexpr std::array<int, 5> kGravity{1, 2, 0, 3, 4};
  const std::uint32_t mode = std::min<std::uint32_t>(record.mode, kGravity.size() - 1);
  if (bucket >= kGravity.size()) return mode;
  return kGravity.at(mode) > kGravity.at(bucket) ? mode : bucket;
}

Json faults_of(const PairMetrics& metrics) {
  Json out = Json::array();
  for (const FaultEvent& fault : metrics.faults) {
    if (out.size() == kMostFaults) break;
    out.push_back({{"t", fault.t_s}, {"side", name_of(fault.side)}, {"name", fault.name}});
  }
  return out;
}

}  // namespace

std::string chart_data(const Run& run, const PairMetrics& metrics) {
  const std::vector<TimedSide> sides = timed_sides(run);
  double rate_Hz = 1.0;
  for (const TimedSide& side : sides) {
    rate_Hz = std::max(rate_Hz, nominal_rate(*side.log));
  }
  const TimeGrid grid = TimeGrid::over(run.seconds, 2.0 / rate_Hz, kMostBuckets);

  std::vector<PairedTick> pairs;
  if (run.master && run.slave) pairs = pair_ticks(*run.master, *run.slave);
  ChartWriter charts{sides, grid};
  write_motion(charts, pairs);
  write_forces(charts);
  write_timing(charts);

  Json frame{{"bucket", grid.bucket_s},      {"buckets", grid.buckets},
             {"end", run.seconds},           {"modes", Json::object()},
             {"limits", Json::object()},     {"limitNames", Json::array()},
             {"faults", faults_of(metrics)}, {"histograms", spread_data(run, metrics)}};
  for (const FaultText& row : fault_table()) {
    if (row.code >= 100) frame["limitNames"].push_back(row.name);
  }
  for (const TimedSide& side : sides) {
    frame["modes"][name_of(side.role)] = runs_of(side, grid, 99, graver);
    frame["limits"][name_of(side.role)] = runs_of(
        side, grid, 0, [](std::uint32_t bits, const TickRecord& r) { return bits | r.limits; });
  }
  std::string text = frame.dump();
  text.pop_back();
  return text + ",\n\"charts\":" + charts.text() + "}\n";
}

}  // namespace teleop
