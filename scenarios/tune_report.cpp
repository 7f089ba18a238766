#include "scenarios/tune_report.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/model/arm_model.hpp"
#include "core/model/kinematics.hpp"
#include "scenarios/tune_journal.hpp"

namespace teleop {

// Points without a crossing are left out first, which the checker does not see through.
// NOLINTBEGIN(bugprone-unchecked-optional-access)
namespace {

constexpr double kShown = 0.05;  ///< smaller entries of a mode shape are left out of the table

nlohmann::json number_or_null(bool has, double value) {
  return has ? nlohmann::json(value) : nlohmann::json(nullptr);
}

GainExperiment experiment_of(const TuneOptions& options) {
  if (options.experiment == "damping") return GainExperiment::damping;
  return options.experiment == "teleop" ? GainExperiment::teleop : GainExperiment::wall;
}

nlohmann::json point_json(const TuneOptions& options, const TunedPoint& p) {
  const bool found = p.result.crossing.has_value();
  const Crossing c = p.result.crossing.value_or(Crossing{});
  nlohmann::json shape = nlohmann::json::array();
  for (const ShapeEntry& e : p.result.shape) {
    shape.push_back({{"side", e.arm == 0 ? "master" : "slave"},
                     {"axis", axis_name(e.axis)},
                     {"ratio", e.ratio},
                     {"phase_rad", e.phase_rad}});
  }
  nlohmann::json stops = nlohmann::json::array();
  nlohmann::json probes = nlohmann::json::array();
  for (const ProbeResult& probe : p.result.probes) {
    stops.push_back(name_of(probe.outcome.stop));
    probes.push_back(to_json(probe));
  }
  nlohmann::json json{{"pose_rad", {p.job.q[0], p.job.q[1], p.job.q[2]}},
                      {"axis", axis_name(p.job.axis)},
                      {"gain", number_or_null(found, c.gain)},
                      {"gain_low", number_or_null(found, c.low)},
                      {"gain_high", number_or_null(found, c.high)},
                      {"unit", unit_of(experiment_of(options))},
                      {"frequency_Hz", number_or_null(found, p.result.frequency_Hz)},
                      {"end", name_of(p.result.end)},
                      {"amplitude_m", p.result.amplitude_m},
                      {"hand", options.hand},
                      {"damping_Ns_per_m", p.job.damping_Ns_per_m},
                      {"mode_shape", shape},
                      {"arm_seconds", p.result.arm_seconds},
                      {"stops", stops},
                      {"probes", probes}};
  if (p.analytic_gain) json["analytic_gain"] = *p.analytic_gain;
  return json;
}

std::string shape_text(const TuneOptions& options, const std::vector<ShapeEntry>& shape) {
  std::string text;
  for (const ShapeEntry& e : shape) {
    if (e.ratio < kShown) continue;
    const bool pair = options.experiment == "teleop";
    const char* side = pair ? (e.arm == 0 ? "master " : "slave ") : "";
    fmt::format_to(std::back_inserter(text), "{}{}{} {:.2f}", text.empty() ? "" : ", ", side,
                   axis_name(e.axis), e.ratio);
    if (std::abs(e.phase_rad) > 0.2) {
      fmt::format_to(std::back_inserter(text), " at {:+.0f}°",
                     e.phase_rad * 180.0 / std::numbers::pi);
    }
  }
  return text;
}

std::string reason_of(SearchEnd end) {
  switch (end) {
    case SearchEnd::no_limit:
      return "stable up to the largest gain tried";
    case SearchEnd::force_limited:
      return "stable up to where the force bound leaves no room for an oscillation";
    case SearchEnd::always_unstable:
      return "unstable at the smallest gain tried";
    case SearchEnd::gave_up:
      return "given up: the arm does not rest, or nothing could be told from its probes";
    default:
      return "stopped";
  }
}

}  // namespace

std::string axis_name(std::size_t axis) { return std::string(1, "xyz"[axis]); }

std::size_t worst_of(const std::vector<TunedPoint>& points) {
  std::size_t worst = points.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].result.crossing) continue;
    const bool lower = worst == points.size() ||
                       points[i].result.crossing->gain < points[worst].result.crossing->gain;
    if (lower) worst = i;
  }
  return worst;
}

nlohmann::json report_json(const TuneOptions& options, const std::vector<TunedPoint>& points) {
  const bool pair = options.experiment == "teleop";
  nlohmann::json json{{"experiment", options.experiment},
                      {"axis", options.axis},
                      {"device", pair ? options.master + ", " + options.slave : options.device},
                      {"hand", options.hand},
                      {"seed", options.seed},
                      {"rate_Hz", options.rate_Hz},
                      {"velocity", options.velocity},
                      {"points", nlohmann::json::array()},
                      {"worst", nullptr}};
  double seconds = 0.0;
  for (const TunedPoint& p : points) {
    json["points"].push_back(point_json(options, p));
    seconds += p.result.arm_seconds;
  }
  json["arm_seconds"] = seconds;
  const std::size_t worst = worst_of(points);
  if (worst < points.size()) {
    const nlohmann::json& point = json["points"][worst];
    json["worst"] = {{"point", worst},
                     {"pose_rad", point.at("pose_rad")},
                     {"axis", point.at("axis")},
                     {"gain", point.at("gain")},
                     {"gain_low", point.at("gain_low")},
                     {"gain_high", point.at("gain_high")},
                     {"unit", point.at("unit")},
                     {"half_gain", 0.5 * point.at("gain").get<double>()}};
  }
  return json;
}

std::string report_table(const TuneOptions& options, const std::vector<TunedPoint>& points) {
  const std::string unit{unit_of(experiment_of(options))};
  std::string text;
  const auto add = std::back_inserter(text);
  fmt::format_to(add, "{:>5}  {:>20}  {:>4}  {:>8}  {:>17}  {:>7}  {:>9}  {:>6}  {}\n", "point",
                 "joints, rad", "axis", unit, "90 % interval", "theory", "frequency", "arm s",
                 "what moves");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TunedPoint& p = points[i];
    fmt::format_to(add, "{:>5}  {:>6.2f} {:>6.2f} {:>6.2f}  {:>4}  ", i, p.job.q[0], p.job.q[1],
                   p.job.q[2], axis_name(p.job.axis));
    if (!p.result.crossing) {
      fmt::format_to(add, "{:>8}  {}\n", "-",
                     p.result.stopped ? "stopped" : reason_of(p.result.end));
      continue;
    }
    const Crossing& c = *p.result.crossing;
    const std::string theory = p.analytic_gain ? fmt::format("{:.4g}", *p.analytic_gain) : "-";
    fmt::format_to(add, "{:>8.4g}  {:>8.5g} {:>8.5g}  {:>7}  {:>6.1f} Hz  {:>6.1f}  {}\n", c.gain,
                   c.low, c.high, theory, p.result.frequency_Hz, p.result.arm_seconds,
                   shape_text(options, p.result.shape));
  }
  const std::size_t worst = worst_of(points);
  if (worst == points.size()) return text + "no gain of marginal stability was found\n";
  const Crossing& c = *points[worst].result.crossing;
  const auto found = std::count_if(points.begin(), points.end(), [](const TunedPoint& p) {
    return p.result.crossing.has_value();
  });
  fmt::format_to(add,
                 "smallest of {}: {:.4g} {} (90 % interval {:.5g} to {:.5g}), point {}, axis {}; "
                 "half of it is {:.4g} {}\n",
                 found, c.gain, unit, c.low, c.high, worst, axis_name(points[worst].job.axis),
                 0.5 * c.gain, unit);
  return text;
}

// NOLINTEND(bugprone-unchecked-optional-access)

}  // namespace teleop
