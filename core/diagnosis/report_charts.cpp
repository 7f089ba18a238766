#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/diagnosis/report_parts.hpp"
#include "core/effects/effect_words.hpp"
#include "core/reporting/escape.hpp"
#include "core/reporting/svg_chart.hpp"

namespace teleop {
namespace {

constexpr double kMilli = 1e3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string figure(const std::string& title, const std::string& svg, bool wide = false) {
  return fmt::format("<div class=\"chart{}\"><h3>{}</h3>{}</div>\n", wide ? " wide" : "",
                     escape_html(title), svg);
}

/// Axes that the page draws maps of: those of the effects and the one that is missed most.
std::vector<std::size_t> drawn_axes(const Diagnosis& diagnosis) {
  std::vector<std::size_t> axes{diagnosis.where.axis};
  for (const NamedEffect& named : diagnosis.found.effects) {
    if (named.effect.axis) axes.push_back(*named.effect.axis);
  }
  std::sort(axes.begin(), axes.end());
  axes.erase(std::unique(axes.begin(), axes.end()), axes.end());
  return axes;
}

std::string map_svg(const MissingMap& map, double scale, std::size_t axis) {
  SvgMap svg{.x_label = fmt::format("angle of axis {} (rad)", axis + 1),
             .y_label = "speed (rad/s)",
             .x_low = map.q_low,
             .x_high = map.q_high,
             .y_low = -map.v_most,
             .y_high = map.v_most,
             .columns = map.columns,
             .rows = map.rows,
             .scale = scale};
  svg.cells.reserve(map.cells.size());
  constexpr std::size_t kFewestRows = 10;
  for (const MissingMean& each : map.cells) {
    svg.cells.push_back(
        {.value = each.mean, .present = each.rows >= kFewestRows, .sure = each.significant()});
  }
  return svg_of(svg);
}

/// The size that few cells exceed, and no less than what chance makes of half of them.
double scale_of(const MissingMap& map) {
  std::vector<double> sizes;
  std::vector<double> chance;
  for (const MissingMean& each : map.cells) {
    if (each.rows == 0) continue;
    sizes.push_back(std::abs(each.mean));
    chance.push_back(3.0 * each.deviation);
  }
  const auto quantile = [](std::vector<double>& values, std::size_t tenths) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() * tenths / 10];
  };
  return std::max({quantile(sizes, 9), quantile(chance, 5), 1e-6});
}

void add_profile(SvgPlot& plot, const MissingProfile& profile, const char* name) {
  SvgPlot::Line line{.label = name, .color = name, .x = profile.middles};
  SvgPlot::Band band{.color = name, .x = profile.middles};
  for (const MissingMean& each : profile.means) {
    line.y.push_back(kMilli * each.mean);
    band.low.push_back(kMilli * (each.mean - each.deviation));
    band.high.push_back(kMilli * (each.mean + each.deviation));
  }
  plot.bands.push_back(std::move(band));
  plot.lines.push_back(std::move(line));
}

/// Rows [first, last) of one run.
struct Stretch {
  std::size_t run = 0;
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Where the nominal model goes astray most, on one axis.
Stretch worst_stretch(const FreeRun& free, Eigen::Index axis, double period_s) {
  constexpr double kLength_s = 3.0;
  const auto length = static_cast<std::size_t>(kLength_s / period_s);
  Stretch worst;
  double most = -1.0;
  for (const FreeRun::Trace& trace : free.traces) {
    const std::size_t rows = trace.nominal.size();
    for (std::size_t first = 0; first < rows; first += length / 6) {
      const std::size_t last = std::min(first + length, rows);
      double sum = 0.0;
      for (std::size_t k = first; k < last; ++k) {
        const double e = trace.nominal[k][axis];
        if (std::isfinite(e)) sum += e * e;
      }
      if (sum <= most) continue;
      most = sum;
      worst = {.run = trace.run, .first = first, .last = last};
    }
  }
  return worst;
}

std::vector<double> seconds_of(const Stretch& stretch, double period_s) {
  std::vector<double> t;
  t.reserve(stretch.last - stretch.first);
  for (std::size_t k = stretch.first; k < stretch.last; k += 2) {
    t.push_back(static_cast<double>(k) * period_s);
  }
  return t;
}

template <class Value>
std::vector<double> values_over(const Stretch& stretch, Value&& value) {
  std::vector<double> values;
  values.reserve(stretch.last - stretch.first);
  for (std::size_t k = stretch.first; k < stretch.last; k += 2) {
    values.push_back(value(k));
  }
  return values;
}

std::string error_chart(const FreeRun::Trace& trace,
                        const Stretch& stretch,
                        Eigen::Index axis,
                        double period_s) {
  const std::vector<double> t = seconds_of(stretch, period_s);
  const auto sigma = [&](double times) {
    return values_over(stretch,
                       [&](std::size_t k) { return times * kMilli * trace.deviation[k][axis]; });
  };
  const auto line = [&](const char* name, const std::vector<JointVector>& errors) {
    return SvgPlot::Line{
        .label = name, .color = name, .x = t, .y = values_over(stretch, [&](std::size_t k) {
                                                return kMilli * errors[k][axis];
                                              })};
  };
  return svg_of(
      SvgPlot{.x_label = "time (s)",
              .y_label = "error (mrad)",
              .width = 1140.0,
              .height = 260.0,
              .lines = {line("nominal", trace.nominal), line("corrected", trace.corrected)},
              .bands = {{.label = "noise, two standard deviations",
                         .color = "noise",
                         .x = t,
                         .low = sigma(-2.0),
                         .high = sigma(2.0)}}});
}

std::string torque_chart(const Localisation& where,
                         const Stretch& stretch,
                         Eigen::Index axis,
                         double period_s) {
  SvgPlot plot{.x_label = "time (s)", .y_label = "missing (mNm)", .width = 1140.0, .height = 230.0};
  const auto add = [&](const char* name, const std::vector<TorqueSmoother::Row>& rows) {
    if (rows.empty()) return;
    plot.lines.push_back(
        {.label = name,
         .color = name,
         .x = seconds_of(stretch, period_s),
         .y = values_over(stretch, [&](std::size_t k) { return kMilli * rows[k].torque[axis]; })});
  };
  add("nominal", where.nominal_rows[stretch.run]);
  add("corrected", where.corrected_rows[stretch.run]);
  return svg_of(plot);
}

}  // namespace

std::string map_charts(const Diagnosis& diagnosis) {
  std::string out;
  for (const std::size_t axis : drawn_axes(diagnosis)) {
    const MissingMap& before = diagnosis.where.nominal.at(axis).map;
    const MissingMap& after = diagnosis.where.corrected.at(axis).map;
    if (before.cells.empty()) continue;
    const double scale = scale_of(before);
    out += figure(fmt::format("Axis {}: torque that the nominal model misses", axis + 1),
                  map_svg(before, scale, axis));
    if (diagnosis.found.effects.empty() || after.cells.empty()) continue;
    out += figure(fmt::format("Axis {}: and the corrected one", axis + 1),
                  map_svg(after, scale, axis));
    out += fmt::format(
        "<p class=\"note wide\"><i class=\"colour\" style=\"background:var(--plus)\"></i>pushes "
        "forward, <i class=\"colour\" style=\"background:var(--minus)\"></i>backward; full colour "
        "is {} or more, pale is what may be chance.</p>\n",
        quantity_text(scale, 0.0, "N m"));
  }
  return out;
}

std::string profile_charts(const Diagnosis& diagnosis) {
  constexpr std::size_t kShown = 4;
  const AxisMiss& before = diagnosis.where.nominal.at(diagnosis.where.axis);
  const AxisMiss& after = diagnosis.where.corrected.at(diagnosis.where.axis);
  std::vector<std::size_t> order(before.profiles.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return before.profiles[a].share > before.profiles[b].share;
  });
  if (order.size() > kShown) order.resize(kShown);
  std::string out;
  for (const std::size_t i : order) {
    const MissingProfile& profile = before.profiles[i];
    SvgPlot plot{.x_label = fmt::format("{} ({})", profile.quantity, profile.unit),
                 .y_label = "missing (mNm)"};
    add_profile(plot, profile, "nominal");
    if (!diagnosis.found.effects.empty() && !after.profiles.empty()) {
      add_profile(plot, after.profiles[i], "corrected");
    }
    out += figure(fmt::format("Axis {} over its {}: {:.0f} % of the missing torque",
                              diagnosis.where.axis + 1, profile.quantity, 100.0 * profile.share),
                  svg_of(plot));
  }
  return out;
}

std::string spectrum_charts(const Diagnosis& diagnosis) {
  const Localisation& where = diagnosis.where;
  std::string out;
  for (const std::size_t axis : drawn_axes(diagnosis)) {
    SvgPlot plot{
        .x_label = "frequency (Hz)", .y_label = "power over noise", .log_x = true, .log_y = true};
    plot.lines.push_back({.label = "nominal",
                          .color = "nominal",
                          .x = where.f_Hz,
                          .y = where.nominal.at(axis).spectrum});
    if (!diagnosis.found.effects.empty()) {
      plot.lines.push_back({.label = "corrected",
                            .color = "corrected",
                            .x = where.f_Hz,
                            .y = where.corrected.at(axis).spectrum});
    }
    plot.lines.push_back({.label = "noise",
                          .color = "noise",
                          .x = where.f_Hz,
                          .y = std::vector<double>(where.f_Hz.size(), 1.0),
                          .dashed = true});
    out += figure(fmt::format("Axis {}", axis + 1), svg_of(plot));
  }
  return out;
}

TraceCharts trace_charts(const Diagnosis& diagnosis, const DiagnosisCase& data) {
  const auto axis = static_cast<Eigen::Index>(diagnosis.where.axis);
  const FreeRun& free = diagnosis.free;
  const Stretch stretch = worst_stretch(free, axis, data.period_s);
  const FreeRun::Trace& trace = free.traces[stretch.run];
  const Recording& run = data.runs[stretch.run];
  TraceCharts result;
  result.note = fmt::format(
      "Axis {} in {}, where the nominal model goes astray most. Both models are held to the "
      "readings for {} s, left to themselves for {} s, and so on, with the parameters that the "
      "other runs ask for.",
      axis + 1, run.name, free.motion_s, free.motion_s);
  SvgPlot angle{.x_label = "time (s)", .y_label = "angle (rad)", .width = 1140.0, .height = 210.0};
  angle.lines.push_back({.label = "reading",
                         .color = "strong",
                         .x = seconds_of(stretch, data.period_s),
                         .y = values_over(stretch, [&](std::size_t k) { return run.q[k][axis]; })});
  const auto predicted = [&](const char* name, const std::vector<JointVector>& errors) {
    angle.lines.push_back({.label = name,
                           .color = name,
                           .x = seconds_of(stretch, data.period_s),
                           .y = values_over(stretch, [&](std::size_t k) {
                             const double e = errors[k][axis];
                             return std::isfinite(e) ? run.q[k][axis] - e : kNone;
                           })});
  };
  predicted("nominal", trace.nominal);
  predicted("corrected", trace.corrected);
  result.html += figure("What was read, and what the models say", svg_of(angle), true);
  result.html +=
      figure("How far they go astray", error_chart(trace, stretch, axis, data.period_s), true);
  result.html += figure("Torque that they miss",
                        torque_chart(diagnosis.where, stretch, axis, data.period_s), true);
  return result;
}

}  // namespace teleop
