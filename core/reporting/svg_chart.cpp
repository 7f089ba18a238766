#include "core/reporting/svg_chart.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "core/reporting/escape.hpp"

namespace teleop {
namespace {

constexpr double kLeft = 58.0;
constexpr double kRight = 12.0;
constexpr double kTop = 10.0;
constexpr double kBottom = 42.0;

/// From numbers to places in a picture.
struct Scale {
  double low = 0.0;
  double high = 1.0;
  double from = 0.0;
  double to = 1.0;
  bool logarithmic = false;

  [[nodiscard]] double share(double value) const {
    if (logarithmic) return std::log(value / low) / std::log(high / low);
    return (value - low) / (high - low);
  }
  [[nodiscard]] double at(double value) const { return from + (to - from) * share(value); }
};

std::string number(double value) {
  const std::string text = fmt::format("{:.4g}", value == 0.0 ? 0.0 : value);
  return text.front() == '-' ? "−" + text.substr(1) : text;
}

std::vector<double> ticks_of(const Scale& scale, int count) {
  if (!scale.logarithmic) return round_ticks(scale.low, scale.high, count);
  std::vector<double> ticks;
  const double decades = std::log10(scale.high / scale.low);
  for (int e = static_cast<int>(std::floor(std::log10(scale.low)));
       e <= static_cast<int>(std::ceil(std::log10(scale.high))); ++e) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double tick = step * std::pow(10.0, e);
      if (step != 1.0 && decades > 3.3) continue;
      if (tick >= 0.999 * scale.low && tick <= 1.001 * scale.high) ticks.push_back(tick);
    }
  }
  return ticks;
}

std::string open_svg(double width, double height, const std::string& label) {
  return fmt::format(
      "<svg class=\"chart-svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", width,
      height, escape_html(label));
}

void add_axes(std::string& out,
              const Scale& x,
              const Scale& y,
              const std::string& x_label,
              const std::string& y_label) {
  auto to = std::back_inserter(out);
  for (const double tick : ticks_of(y, 5)) {
    fmt::format_to(to,
                   "<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                   x.from, x.to, y.at(tick), y.at(tick));
    fmt::format_to(to, "<text text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                   x.from - 6.0, y.at(tick) + 4.0, number(tick));
  }
  for (const double tick : ticks_of(x, 7)) {
    fmt::format_to(to,
                   "<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                   x.at(tick), x.at(tick), y.from, y.to);
    fmt::format_to(to, "<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                   x.at(tick), y.from + 16.0, number(tick));
  }
  fmt::format_to(to, "<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                 (x.from + x.to) / 2.0, y.from + 34.0, escape_html(x_label));
  fmt::format_to(
      to, "<text text-anchor=\"middle\" transform=\"translate(13 {:.1f}) rotate(-90)\">{}</text>",
      (y.from + y.to) / 2.0, escape_html(y_label));
}

/// Least and largest of what is a number.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(const std::vector<double>& values, bool positive) {
    for (const double value : values) {
      if (!std::isfinite(value) || (positive && value <= 0.0)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

std::string path_of(const SvgPlot::Line& line, const Scale& x, const Scale& y) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const double value = y.logarithmic ? std::max(line.y[i], y.low) : line.y[i];
    if (!std::isfinite(value)) {
      pen_down = false;
      continue;
    }
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", pen_down ? "L" : "M",
                   x.at(line.x[i]), y.at(value));
    pen_down = true;
  }
  return path;
}

/// A stretch of a band between breaks.
struct Patch {
  std::size_t first = 0;
  std::size_t last = 0;  ///< one past it
};

void add_patch(std::string& out,
               const SvgPlot::Band& band,
               const Patch& patch,
               const Scale& x,
               const Scale& y) {
  const auto [first, last] = patch;
  if (last <= first + 1) return;
  std::string path;
  auto to = std::back_inserter(path);
  const auto held = [&](double value) {
    return y.at(std::clamp(value, y.low, y.high));
  };
  for (std::size_t i = first; i < last; ++i) {
    fmt::format_to(to, "{}{:.1f} {:.1f}", i == first ? "M" : "L", x.at(band.x[i]),
                   held(band.high[i]));
  }
  for (std::size_t i = last; i-- > first;) {
    fmt::format_to(to, "L{:.1f} {:.1f}", x.at(band.x[i]), held(band.low[i]));
  }
  fmt::format_to(std::back_inserter(out),
                 "<path class=\"band\" style=\"fill:var(--{})\" d=\"{}Z\"/>", band.color, path);
}

void add_band(std::string& out, const SvgPlot::Band& band, const Scale& x, const Scale& y) {
  std::size_t first = 0;
  for (std::size_t i = 0; i <= band.x.size(); ++i) {
    const bool ends =
        i == band.x.size() || !std::isfinite(band.low[i]) || !std::isfinite(band.high[i]);
    if (!ends) continue;
    add_patch(out, band, {first, i}, x, y);
    first = i + 1;
  }
}

std::string legend_of(const SvgPlot& plot) {
  std::string keys;
  auto to = std::back_inserter(keys);
  for (const SvgPlot::Line& line : plot.lines) {
    if (line.label.empty()) continue;
    fmt::format_to(
        to,
        "<span class=\"key\"><i class=\"line{}\" style=\"border-color:var(--{})\"></i>{}</span>",
        line.dashed ? " dashed" : "", line.color, escape_html(line.label));
  }
  for (const SvgPlot::Band& band : plot.bands) {
    if (band.label.empty()) continue;
    fmt::format_to(to,
                   "<span class=\"key\"><i class=\"patch\" "
                   "style=\"background:var(--{});opacity:.35\"></i>{}</span>",
                   band.color, escape_html(band.label));
  }
  return keys.empty() ? keys : "<div class=\"keys\">" + keys + "</div>";
}

Scale y_scale(const SvgPlot& plot, const Extent& extent) {
  Scale y{.from = plot.height - kBottom, .to = kTop, .logarithmic = plot.log_y};
  if (plot.y_low < plot.y_high) {
    y.low = plot.y_low;
    y.high = plot.y_high;
  } else if (plot.log_y) {
    y.low = extent.low / 1.3;
    y.high = extent.high * 1.3;
  } else {
    const double room = 0.06 * std::max(extent.high - extent.low, 1e-12);
    y.low = extent.low - room;
    y.high = extent.high + room;
  }
  return y;
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int count) {
  if (!(high > low)) return {};
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double each : {1.0, 2.0, 5.0}) {
    if (each * power >= rough) {
      step = each * power;
      break;
    }
  }
  std::vector<double> ticks;
  for (auto k = std::llround(std::ceil(low / step - 1e-9));
       static_cast<double>(k) * step <= high + 1e-9 * step; ++k) {
    ticks.push_back(static_cast<double>(k) * step);
  }
  return ticks;
}

std::string svg_of(const SvgPlot& plot) {
  Extent across;
  Extent up;
  for (const SvgPlot::Line& line : plot.lines) {
    across.take(line.x, plot.log_x);
    up.take(line.y, plot.log_y);
  }
  for (const SvgPlot::Band& band : plot.bands) {
    across.take(band.x, plot.log_x);
    up.take(band.low, plot.log_y);
    up.take(band.high, plot.log_y);
  }
  if (across.empty() || up.empty() || across.low == across.high) {
    return "<p class=\"note\">Nothing to draw.</p>";
  }
  const Scale x{.low = across.low,
                .high = across.high,
                .from = kLeft,
                .to = plot.width - kRight,
                .logarithmic = plot.log_x};
  const Scale y = y_scale(plot, up);
  std::string out =
      legend_of(plot) + open_svg(plot.width, plot.height, plot.y_label + " over " + plot.x_label);
  add_axes(out, x, y, plot.x_label, plot.y_label);
  for (const SvgPlot::Band& band : plot.bands) {
    add_band(out, band, x, y);
  }
  for (const SvgPlot::Line& line : plot.lines) {
    fmt::format_to(std::back_inserter(out),
                   "<path class=\"curve{}\" style=\"stroke:var(--{})\" d=\"{}\"/>",
                   line.dashed ? " dashed" : "", line.color, path_of(line, x, y));
  }
  return out + "</svg>";
}

std::string svg_of(const SvgMap& map) {
  const Scale x{.low = map.x_low, .high = map.x_high, .from = kLeft, .to = map.width - kRight};
  const Scale y{.low = map.y_low, .high = map.y_high, .from = map.height - kBottom, .to = kTop};
  std::string out = open_svg(map.width, map.height, map.y_label + " over " + map.x_label);
  add_axes(out, x, y, map.x_label, map.y_label);
  const double width = (x.to - x.from) / static_cast<double>(map.columns);
  const double height = (y.from - y.to) / static_cast<double>(map.rows);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const SvgMap::Cell& cell = map.cells[i];
    if (!cell.present) continue;
    constexpr double kPale = 0.45;
    const double share = std::min(std::abs(cell.value) / map.scale, 1.0);
    const std::size_t row = i / map.columns;
    const double left = x.from + width * static_cast<double>(i % map.columns);
    const double top = y.from - height * static_cast<double>(row + 1);
    fmt::format_to(
        std::back_inserter(out),
        "<rect class=\"cell\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>"
        "<rect style=\"fill:var(--{})\" fill-opacity=\"{:.2f}\" x=\"{:.1f}\" y=\"{:.1f}\" "
        "width=\"{:.1f}\" height=\"{:.1f}\"/>",
        left, top, width, height, cell.value > 0.0 ? "plus" : "minus",
        share * (cell.sure ? 1.0 : kPale), left, top, width, height);
  }
  return out + "</svg>";
}

}  // namespace teleop
