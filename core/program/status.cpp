#include "core/program/status.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/fault.hpp"

namespace teleop {
namespace {

double microseconds(Duration duration) { return 1e6 * seconds(duration); }

}  // namespace

std::string status_line(Role role, const Status& status, const Histogram& lateness) {
  const TickRecord& r = status.record;
  std::string line = fmt::format(
      "{} {:<8} turn {:>8}  error {:6.2f} mm  force {:5.2f} N  rtt {:5.0f} us  age {:5.2f} ms  "
      "lost {}  "
      "late p99 {:4.0f} us",
      name_of(role), name_of(static_cast<Mode>(r.mode)), r.tick, 1e3 * r.error_m.norm(),
      r.coupling_N.norm(), r.round_trip_us, r.peer_age_ms, r.packets_lost,
      microseconds(lateness.quantile(0.99)));
  if (r.fault != 0) line += fmt::format("  FAULT {}", name_of(static_cast<Fault>(r.fault)));
  return line;
}

std::string status_json(Role role, const Status& status, const Histogram& lateness) {
  const TickRecord& r = status.record;
  return nlohmann::json{
      {"role", name_of(role)},
      {"mode", name_of(static_cast<Mode>(r.mode))},
      {"tick", r.tick},
      {"turns", status.turns},
      {"missed", status.missed},
      {"dropped", status.dropped},
      {"error_mm", 1e3 * r.error_m.norm()},
      {"force_N", r.coupling_N.norm()},
      {"rtt_us", r.round_trip_us},
      {"age_ms", r.peer_age_ms},
      {"lost", r.packets_lost},
      {"lateness_p99_us", microseconds(lateness.quantile(0.99))},
      {"fault", r.fault},
      {"fault_name", name_of(static_cast<Fault>(r.fault))},
  }
      .dump();
}

}  // namespace teleop
