#include "scenarios/sweep_picture.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scenarios/gnuplot.hpp"

namespace teleop {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLabels = 12;

/// What a picture needs of an axis: its distinct values in order, and where each point lies.
struct Scale {
  std::string label{};
  bool numeric = true;
  bool logarithmic = false;
  std::vector<std::string> values{};    ///< as JSON, ascending where numeric
  std::vector<std::size_t> position{};  ///< of point i in `values`

  [[nodiscard]] double number(std::size_t i) const { return std::stod(values[i]); }

  /// "set xrange [...]" with a little room at both ends.
  [[nodiscard]] std::string range(char axis) const {
    double low = 0.0;
    double high = static_cast<double>(values.size() - 1);
    if (numeric) {
      low = number(0);
      high = number(values.size() - 1);
    }
    const bool ratio = numeric && logarithmic;
    const double room = ratio ? std::pow(high / low, 0.03) : 0.03 * (high - low);
    return fmt::format("set {}range [{:.9g}:{:.9g}]\n", axis, ratio ? low / room : low - room,
                       ratio ? high * room : high + room);
  }

  /// "set xtics (...)" of a scale whose steps lie side by side, whatever their distance.
  [[nodiscard]] std::string tics(char axis) const {
    const std::size_t every = (values.size() + kMostLabels - 1) / kMostLabels;
    std::string text = fmt::format("set {}tics {}(", axis, numeric ? "" : "rotate by -20 ");
    for (std::size_t i = 0; i < values.size(); i += every) {
      const std::string name =
          numeric ? fmt::format("{:.4g}", number(i)) : Json::parse(values[i]).dump();
      fmt::format_to(std::back_inserter(text), "{}\"{}\" {}", i == 0 ? "" : ", ",
                     gnuplot_text(numeric ? name : name.substr(1, name.size() - 2)), i);
    }
    return text + ")\n";
  }
};

Scale scale_of(const SweepPlan& plan, std::size_t axis) {
  Scale scale{.label = fmt::format("{}", fmt::join(plan.axes()[axis].keys, ", ")),
              .logarithmic = plan.axes()[axis].logarithmic};
  std::vector<std::string> all;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    all.push_back(plan.value(axis, i).json);
    scale.numeric = scale.numeric && Json::parse(all.back()).is_number();
    const bool known =
        std::find(scale.values.begin(), scale.values.end(), all.back()) != scale.values.end();
    if (!known) scale.values.push_back(all.back());
  }
  if (scale.numeric) {
    std::sort(scale.values.begin(), scale.values.end(),
              [](const auto& a, const auto& b) { return std::stod(a) < std::stod(b); });
  }
  for (const std::string& value : all) {
    const auto found = std::find(scale.values.begin(), scale.values.end(), value);
    scale.position.push_back(static_cast<std::size_t>(found - scale.values.begin()));
  }
  return scale;
}

/// One result over all points.
using Column = std::vector<std::optional<double>>;

std::map<std::string, Column> columns_of(const SweepPlan& plan, const SweepStore& store) {
  std::map<std::string, Column> columns;
  for (const auto& [index, line] : store.lines()) {
    const Json json = Json::parse(line);
    for (const auto& [name, value] : json.at("results").items()) {
      Column& column = columns[name];
      column.resize(plan.size());
      if (value.is_number()) column[index] = value.get<double>();
    }
  }
  return columns;
}

struct Bounds {
  double low = INFINITY;
  double high = -INFINITY;
};

Bounds bounds_of(const Column& column) {
  Bounds bounds;
  for (const auto& value : column) {
    if (!value) continue;
    bounds.low = std::min(bounds.low, *value);
    bounds.high = std::max(bounds.high, *value);
  }
  return bounds;
}

std::string head(const std::string& name) {
  return fmt::format(
      "set terminal pngcairo size 1100,760 font \"Sans,14\" noenhanced\n"
      "set output \"{0}.png\"\nset title \"{0}\"\nset border lw 1 lc rgb \"#444444\"\n"
      "set tics nomirror out\n",
      name);
}

std::string line_picture(const std::string& name, const Scale& x, const Column& column) {
  std::vector<std::pair<std::size_t, double>> points;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (const auto& value = column[i]) points.emplace_back(x.position[i], *value);
  }
  std::sort(points.begin(), points.end());
  std::string script = head(name) + "$data << END\n";
  for (const auto& [position, value] : points) {
    const std::string at = x.numeric ? x.values[position] : std::to_string(position);
    fmt::format_to(std::back_inserter(script), "{} {:.9g}\n", at, value);
  }
  script += "END\n";
  if (x.numeric && x.logarithmic) script += "set logscale x\n";
  if (!x.numeric) script += x.tics('x');
  fmt::format_to(std::back_inserter(script),
                 "set border 3\nset grid lt 1 lc rgb \"#dddddd\"\nset xlabel \"{}\"\n"
                 "set ylabel \"{}\"\n{}set autoscale yfix\n"
                 "set offsets 0,0,graph 0.05,graph 0.03\n"
                 "plot $data using 1:2 with linespoints lw 2 pt 7 ps 1.2 lc rgb \"#1f5fa8\" "
                 "notitle\n",
                 gnuplot_text(x.label), name, x.range('x'));
  return script;
}

/// The steps of both axes side by side as coloured cells, or marks where two axes make no grid.
std::string map_picture(
    const std::string& name, const Scale& x, const Scale& y, const Column& column, bool grid) {
  const Bounds bounds = bounds_of(column);
  const bool as_numbers = !grid && x.numeric && y.numeric;
  std::string script = head(name) + "$data << END\n";
  for (std::size_t i = 0; i < column.size(); ++i) {
    const auto& value = column[i];
    if (!grid && !value) continue;
    const auto at = [&](const Scale& scale) {
      return as_numbers ? scale.values[scale.position[i]] : std::to_string(scale.position[i]);
    };
    fmt::format_to(std::back_inserter(script), "{} {} {}\n", at(x), at(y),
                   value ? fmt::format("{:.9g}", *value) : "NaN");
  }
  script += "END\n";
  if (!as_numbers) {
    script += x.tics('x') + y.tics('y');
    fmt::format_to(std::back_inserter(script), "set xrange [-0.5:{}.5]\nset yrange [-0.5:{}.5]\n",
                   x.values.size() - 1, y.values.size() - 1);
  } else {
    if (x.logarithmic) script += "set logscale x\n";
    if (y.logarithmic) script += "set logscale y\n";
    script += x.range('x') + y.range('y');
  }
  if (bounds.low > 0.0 && bounds.high > 30.0 * bounds.low) script += "set logscale cb\n";
  fmt::format_to(
      std::back_inserter(script),
      "set palette defined (0 \"#fff7d6\", 0.35 \"#f4a259\", 0.7 \"#a83279\", 1 \"#2b0f54\")\n"
      "set xlabel \"{}\"\nset ylabel \"{}\" offset -1,0\nset lmargin 12\nset rmargin 14\n"
      "set object 1 rectangle from graph 0,0 to graph 1,1 behind fc rgb \"#eeeeee\" lw 0\n"
      "plot $data using 1:2:3 with {} notitle\n",
      gnuplot_text(x.label), gnuplot_text(y.label),
      grid ? "image pixels" : "points pt 7 ps 2 palette");
  return script;
}

}  // namespace

bool draw_sweep(const SweepPlan& plan, const SweepStore& store) {
  if (plan.axes().size() > 2) {
    fmt::print(stderr, "no pictures: {} axes; results.csv has every point\n", plan.axes().size());
    return true;
  }
  const bool two = plan.axes().size() == 2;
  const Scale x = scale_of(plan, 0);
  const Scale y = two ? scale_of(plan, 1) : Scale{};
  bool drawn = true;
  for (const auto& [name, column] : columns_of(plan, store)) {
    const Bounds bounds = bounds_of(column);
    if (!(bounds.high > bounds.low)) continue;
    const bool grid = plan.method() == SweepPlan::Method::grid;
    drawn = draw_with_gnuplot(
                store.folder(), name,
                two ? map_picture(name, x, y, column, grid) : line_picture(name, x, column)) &&
            drawn;
  }
  return drawn;
}

}  // namespace teleop
