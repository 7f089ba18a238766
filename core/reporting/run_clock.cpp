#include "core/reporting/run_clock.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace teleop {
namespace {

constexpr std::int64_t kWindow = 10'000'000'000;  // ns

/// Smallest differences of a window; the unset value is far from any clock.
struct Extremes {
  static constexpr std::int64_t kUnset = std::numeric_limits<std::int64_t>::max();
  std::int64_t to_master = kUnset;
  std::int64_t to_slave = kUnset;
};

std::string host_of(const Log& log) {
  const auto host = log.metadata.find("host");
  return host == log.metadata.end() ? std::string{} : host->second;
}

/// Calls visit(received, sent) once for every packet that arrived.
template <class Visit>
void for_each_arrival(const Log& log, Visit&& visit) {
  std::int64_t last = 0;
  for (const TickRecord& record : log.ticks) {
    if (record.peer_session == 0 || record.peer_received_ns == last) continue;
    last = record.peer_received_ns;
    visit(record.peer_received_ns, record.peer_sent_ns);
  }
}

}  // namespace

RunClock RunClock::of_slave(const Log& master, const Log& slave) {
  RunClock clock;
  if (host_of(master) == host_of(slave)) return clock;

  std::map<std::int64_t, Extremes> windows;
  for_each_arrival(master, [&](std::int64_t received, std::int64_t sent) {
    Extremes& window = windows[sent / kWindow];
    window.to_master = std::min(window.to_master, received - sent);
  });
  for_each_arrival(slave, [&](std::int64_t received, std::int64_t sent) {
    Extremes& window = windows[received / kWindow];
    window.to_slave = std::min(window.to_slave, received - sent);
  });
  for (const auto& [index, window] : windows) {
    if (window.to_master == Extremes::kUnset || window.to_slave == Extremes::kUnset) continue;
    clock.nodes_.push_back({.stamp_ns = index * kWindow + kWindow / 2,
                            .offset_ns = (window.to_master - window.to_slave) / 2});
    const auto round_trip = static_cast<double>(window.to_master + window.to_slave);
    clock.error_bound_us_ = std::max(clock.error_bound_us_, 0.5e-3 * round_trip);
  }
  clock.unknown_ = clock.nodes_.empty();
  return clock;
}

std::int64_t RunClock::offset_ns(std::int64_t stamp_ns) const noexcept {
  if (nodes_.empty()) return 0;
  const auto after =
      std::lower_bound(nodes_.begin(), nodes_.end(), stamp_ns,
                       [](const Node& node, std::int64_t stamp) { return node.stamp_ns < stamp; });
  if (after == nodes_.begin()) return nodes_.front().offset_ns;
  if (after == nodes_.end()) return nodes_.back().offset_ns;
  const Node& before = *(after - 1);
  const double share = static_cast<double>(stamp_ns - before.stamp_ns) /
                       static_cast<double>(after->stamp_ns - before.stamp_ns);
  return before.offset_ns + static_cast<std::int64_t>(
                                share * static_cast<double>(after->offset_ns - before.offset_ns));
}

double RunClock::seconds(std::int64_t stamp_ns) const noexcept {
  return 1e-9 * static_cast<double>(stamp_ns + offset_ns(stamp_ns) - begin_ns_);
}

}  // namespace teleop
