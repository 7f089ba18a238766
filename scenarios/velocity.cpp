#include "scenarios/velocity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scenarios/gnuplot.hpp"
#include "scenarios/output.hpp"
#include "scenarios/velocity_picture.hpp"
#include "scenarios/velocity_study.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kMilli = 1000.0;  // m to mm, s to ms
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

json limits_json(const VelocityRow& row) {
  json all = json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& limit = row.limits.at(i);
    all.push_back({{"axis", kAxes.at(i)},
                   {"damping_Ns_per_m", limit ? json(limit->damping_Ns_per_m) : json()},
                   {"frequency_Hz", limit ? json(limit->frequency_Hz) : json()},
                   {"method", row.linear ? "exact" : "describing function"}});
  }
  return all;
}

/// The least of the three axes; nothing when one of them has none.
json least_limit(const VelocityRow& row) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& limit : row.limits) {
    if (limit) least = std::min(least, limit->damping_Ns_per_m);
  }
  return std::isfinite(least) ? json(least) : json();
}

json row_json(const VelocityRow& row) {
  json classes = json::array();
  for (const SpeedClass& c : row.score.classes) {
    classes.push_back(
        {{"from_mm_per_s", kMilli * c.low_m_per_s},
         {"to_mm_per_s", std::isfinite(c.high_m_per_s) ? json(kMilli * c.high_m_per_s) : json()},
         {"samples", c.samples},
         {"rms_mm_per_s", kMilli * c.rms_m_per_s},
         {"worst_mm_per_s", kMilli * c.worst_m_per_s}});
  }
  return {{"kind", row.config.kind},
          {"name", row.name},
          {"lag_ms", kMilli * row.score.lag_s},
          {"stated_lag_ms", row.stated_lag_s ? json(kMilli * *row.stated_lag_s) : json()},
          {"noise_mm_per_s", kMilli * row.score.noise_m_per_s},
          {"rms_error_mm_per_s", kMilli * row.score.rms_m_per_s},
          {"worst_error_by_speed", classes},
          {"max_damping_Ns_per_m", least_limit(row)},
          {"max_damping", limits_json(row)}};
}

json study_json(const VelocityStudy& study, const VelocityOptions& options) {
  json sources = json::array();
  for (const VelocityTrace& trace : study.source.traces) {
    sources.push_back({{"source", trace.source},
                       {"samples", trace.samples.size()},
                       {"seconds", trace.time_s.back() - trace.time_s.front()}});
  }
  json loop = json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    const SampledMass& mass = study.loop.mass.at(i);
    loop.push_back({{"axis", kAxes.at(i)},
                    {"mass_kg", mass.mass_kg},
                    {"physical_damping_Ns_per_m", mass.damping_Ns_per_m},
                    {"period_s", mass.period_s},
                    {"amplitude_m", study.loop.amplitude_m.at(i)}});
  }
  json rows = json::array();
  for (const VelocityRow& row : study.rows) {
    rows.push_back(row_json(row));
  }
  return {{"sources", sources},
          {"reference", study.source.has_truth ? "truth" : "zero-phase smoother"},
          {"reference_bandwidth_Hz", study.source.has_truth ? json() : json(options.reference_Hz)},
          {"noise_above_Hz", study.rows.front().score.noise_above_Hz},
          {"period_counter", study.source.has_period},
          {"damping_loop", loop},
          {"rows", rows}};
}

std::string limit_text(const std::optional<DampingLimit>& limit) {
  return limit ? fmt::format("{:.3g}", limit->damping_Ns_per_m) : "none";
}

std::string table(const VelocityStudy& study, const VelocityOptions& options) {
  std::string text;
  const auto add = [&](const std::string& line) {
    text += line + '\n';
  };
  add(fmt::format("{:<20} {:>7} {:>7}   {:^31}   {:^22}", "", "lag", "noise",
                  "worst error, mm/s, at mm/s", "largest damping, N s/m"));
  add(fmt::format("{:<20} {:>7} {:>7}   {:>7}{:>8}{:>8}{:>8}   {:>6} {:>6} {:>6}", "", "ms", "mm/s",
                  "<5", "<20", "<100", ">100", "x", "y", "z"));
  for (const VelocityRow& row : study.rows) {
    const auto& c = row.score.classes;
    add(fmt::format(
        "{:<20} {:>7.2f} {:>7.2f}   {:>7.1f}{:>8.1f}{:>8.1f}{:>8.1f}   {:>6} {:>6} {:>6}{}",
        row.name, kMilli * row.score.lag_s, kMilli * row.score.noise_m_per_s,
        kMilli * c[0].worst_m_per_s, kMilli * c[1].worst_m_per_s, kMilli * c[2].worst_m_per_s,
        kMilli * c[3].worst_m_per_s, limit_text(row.limits[0]), limit_text(row.limits[1]),
        limit_text(row.limits[2]), row.linear ? "" : " ~"));
  }
  if (study.source.has_truth) {
    add("Reference: the simulated arm's own speed.");
  } else {
    add(
        fmt::format("Reference: the recorded positions, smoothed without phase up to {:g} Hz: no "
                    "truth, and blind above.",
                    options.reference_Hz));
  }
  add(fmt::format(
      "Noise: what the error has above {:g} Hz. Damping: a rigid tool at home with {:g} "
      "N s/m of its own, no other delay; ~ by describing function at {:.2g} mm.",
      study.rows.front().score.noise_above_Hz, options.damping_Ns_per_m,
      kMilli * study.loop.amplitude_m[2]));
  if (!study.source.has_period) {
    add("The arm has no period counter: 'period' saw counts and the loop's clock only.");
  }
  return text;
}

}  // namespace

int run_velocity(const VelocityOptions& options) {
  if (options.print_config) {
    fmt::print("{}", velocity_settings(options));
    return 0;
  }
  const VelocityStudy study = study_velocity(options);
  const fs::path where = make_folder(options.out);
  if (!options.json.empty()) write_json(options.json, study_json(study, options));
  bool drawn = true;
  std::string files;
  for (const VelocityPicture& picture : velocity_pictures(study)) {
    const bool this_one = draw_with_gnuplot(where, picture.name, picture.script);
    if (this_one) files += (where / (picture.name + ".png")).string() + '\n';
    drawn = drawn && this_one;
  }
  fmt::print("{}{}", table(study, options), files);
  return drawn ? 0 : 1;
}

}  // namespace teleop
