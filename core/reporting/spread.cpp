#include "core/reporting/spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

using Json = nlohmann::json;

/// The neighbour below or above of 1, 2, 5, 10 …
double round_number(double value, bool up) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  constexpr std::array kSteps{1.0, 2.0, 5.0, 10.0};
  double below = decade;
  for (const double step : kSteps) {
    if (up && step * decade >= value) return step * decade;
    if (step * decade <= value) below = step * decade;
  }
  return below;
}

struct HistogramText {
  const char* title;
  const char* unit;
  const Distribution& pooled;
};

Json histogram_of(const HistogramText& text,
                  const std::vector<std::pair<Role, std::vector<double>>>& sides) {
  constexpr double kBinsADecade = 24.0;
  constexpr double kMostDecades = 5.0;
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const auto& [role, values] : sides) {
    for (const double value : values) {
      if (!std::isfinite(value) || value <= 0.0) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  Json out{{"title", text.title},
           {"unit", text.unit},
           {"p50", text.pooled.p50},
           {"p99", text.pooled.p99},
           {"series", Json::array()}};
  if (most <= 0.0) return out;
  const double high = round_number(most, true);
  const double low = std::max(round_number(least, false), high * std::pow(10.0, -kMostDecades));
  const double from = low < high ? low : 0.5 * high;
  const auto bins = static_cast<std::size_t>(std::ceil(kBinsADecade * std::log10(high / from)));
  for (const auto& [role, values] : sides) {
    if (values.empty()) continue;
    const Histogram histogram = log_histogram(values, from, high, bins);
    out["edges"] = {from, high, bins};
    out["series"].push_back({{"label", name_of(role)}, {"counts", histogram.counts}});
  }
  return out;
}

}  // namespace

Json spread_data(const Run& run, const PairMetrics& metrics) {
  std::vector<std::pair<Role, std::vector<double>>> lateness;
  std::vector<std::pair<Role, std::vector<double>>> round_trip;
  std::vector<std::pair<Role, std::vector<double>>> age;
  for (const Side* side : run.sides()) {
    const Log& log = *side->log;
    const Role role = role_of(log);
    Samples samples = samples_of(log);
    lateness.emplace_back(role, std::move(samples.lateness_us));
    round_trip.emplace_back(role, std::move(samples.round_trip_us));
    age.emplace_back(role, std::move(samples.age_ms));
  }
  return Json::array({histogram_of({"Lateness", "µs", metrics.lateness_us}, lateness),
                      histogram_of({"Round trip", "µs", metrics.round_trip_us}, round_trip),
                      histogram_of({"Age of the peer's state", "ms", metrics.age_ms}, age)});
}

}  // namespace teleop
