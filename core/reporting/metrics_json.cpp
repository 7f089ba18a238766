#include <cmath>

#include <nlohmann/json.hpp>

#include "core/reporting/metrics.hpp"

namespace teleop {
namespace {

using Json = nlohmann::json;

/// {"p50": …}: the named statistics, null where there was no sample.
Json json_of(const Distribution& d, std::initializer_list<const char*> names) {
  Json out = Json::object();
  for (const std::string_view name : names) {
    const double value = name == "p50"    ? d.p50
                         : name == "p90"  ? d.p90
                         : name == "p99"  ? d.p99
                         : name == "p999" ? d.p999
                                          : d.max;
    out[std::string{name}] = d.count == 0 ? Json() : Json(value);
  }
  return out;
}

Json json_of(const Packets& packets) {
  return {{"sent", packets.sent},
          {"received", packets.received},
          {"lost", packets.lost},
          {"duplicated", packets.duplicated},
          {"reordered", packets.reordered}};
}

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

/// {"master": …, "slave": …} of one member, null for a side without a log.
template <class Member>
Json sides(const PairMetrics& metrics, Member&& member) {
  const auto of = [&](const std::optional<SideMetrics>& side) {
    return side ? Json(member(*side)) : Json();
  };
  return {{"master", of(metrics.master)}, {"slave", of(metrics.slave)}};
}

Json faults_of(const PairMetrics& metrics) {
  Json out = Json::array();
  for (const FaultEvent& fault : metrics.faults) {
    out.push_back({{"side", name_of(fault.side)},
                   {"t_s", fault.t_s},
                   {"code", fault.code},
                   {"name", fault.name},
                   {"cause", fault.cause}});
  }
  return out;
}

Json limits_of(const PairMetrics& metrics) {
  Json out = Json::array();
  for (const LimitCount& limit : metrics.limits) {
    out.push_back({{"side", name_of(limit.side)},
                   {"code", limit.code},
                   {"name", limit.name},
                   {"ticks", limit.ticks}});
  }
  return out;
}

Json outages_of(const PairMetrics& metrics) {
  Json out = Json::array();
  for (const Outage& outage : metrics.outages) {
    out.push_back({{"side", name_of(outage.side)},
                   {"t_s", outage.t_s},
                   {"length_s", outage.length_s},
                   {"ended", outage.ended}});
  }
  return out;
}

Json contact_of(const PairMetrics& metrics) {
  if (!metrics.rest_contact) return {};
  const RestContact& contact = *metrics.rest_contact;
  return {{"ratio", contact.ratio},
          {"seconds", contact.seconds},
          {"hand_force_N", contact.hand_force_N},
          {"wall_force_N", contact.wall_force_N}};
}

/// What a reader of a run asks next.
void add_more(const PairMetrics& metrics, Json& out) {
  out["seconds"] = metrics.seconds;
  out["nominal_rate_Hz"] = metrics.first().nominal_rate_Hz;
  out["tick_share"] = sides(metrics, [](const SideMetrics& s) { return s.tick_share; });
  out["engaged_share"] = metrics.engaged_share;
  out["engaged_seconds"] = metrics.tracking ? Json(metrics.tracking->seconds) : Json();
  out["contact_at_rest"] = contact_of(metrics);
  out["peak_force_N"] = sides(metrics, [](const SideMetrics& s) { return s.coupling_peak_N; });
  out["peak_tool_force_N"] =
      sides(metrics, [](const SideMetrics& s) { return or_null(s.tool_force_peak_N); });
  out["coupling_energy_J"] =
      sides(metrics, [](const SideMetrics& s) { return s.coupling_energy_J; });
  out["port_energy_J"] =
      sides(metrics, [](const SideMetrics& s) { return or_null(s.port_energy_J); });
  out["law_error_rms_mm"] = sides(metrics, [](const SideMetrics& s) { return s.law_error_rms_mm; });
  out["overruns"] = sides(metrics, [](const SideMetrics& s) { return s.overruns; });
  out["late_turns"] = sides(metrics, [](const SideMetrics& s) { return s.late_turns; });
  out["dropped_records"] = sides(metrics, [](const SideMetrics& s) { return s.dropped_records; });
  out["damage"] = sides(metrics, [](const SideMetrics& s) { return s.damage; });
  out["limits"] = limits_of(metrics);
  out["outages"] = outages_of(metrics);
  out["clock_error_bound_us"] = metrics.clock_error_bound_us;
}

}  // namespace

Json to_json(const PairMetrics& metrics) {
  Json out;
  out["rate_Hz"] = metrics.first().rate_Hz;
  out["ticks"] = sides(metrics, [](const SideMetrics& s) { return s.ticks; });
  out["tracking_rms_mm"] = metrics.tracking ? Json(metrics.tracking->rms_mm) : Json();
  out["tracking_peak_mm"] = metrics.tracking ? Json(metrics.tracking->peak_mm) : Json();
  out["force_rms_N"] = metrics.first().coupling_rms_N;
  out["rtt_us"] = json_of(metrics.round_trip_us, {"p50", "p99", "p999"});
  out["lateness_us"] = json_of(metrics.lateness_us, {"p50", "p90", "p99", "p999", "max"});
  out["compute_us"] = json_of(metrics.compute_us, {"p50", "p99"});
  out["age_ms"] = json_of(metrics.age_ms, {"p50", "p99"});
  out["packets"] = json_of(metrics.packets);
  out["faults"] = faults_of(metrics);
  add_more(metrics, out);
  return out;
}

}  // namespace teleop
