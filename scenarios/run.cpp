#include "scenarios/run.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "scenarios/gnuplot.hpp"
#include "scenarios/listening.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// The catalogue with a line each, and the kinds of experiments.
int list_scenarios() {
  std::puts("scenarios of the catalogue (teleop run NAME):");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator{data_file("catalogue")}) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const Scenario scenario{read_scenario(file.string())};
    fmt::print("  {:<24} {}\n", file.stem().string(), scenario.text());
  }
  std::puts("experiments that a scenario file can ask for:");
  for (const ExperimentKind* kind : experiments()) {
    fmt::print("  {:<24} {}\n", kind->name, kind->text);
  }
  return 0;
}

/// A script for a figure whose curves stand in NAME.csv as columns x,y in blocks.
std::string script_of(const Figure& figure) {
  std::string script = fmt::format(
      "set terminal pngcairo size 1100,700 font \"Sans,14\" noenhanced\nset output \"{0}.png\"\n"
      "set datafile separator \",\"\nset title \"{1}\"\nset xlabel \"{2}\"\nset ylabel \"{3}\"\n"
      "set grid lt 1 lc rgb \"#dddddd\"\nset border 3\nset tics nomirror\n"
      "set autoscale fix\nset bmargin 5.5\nset key outside bottom center horizontal\nset offsets "
      "0,0,graph 0.05,graph 0.03\n{4}plot ",
      figure.name, gnuplot_text(figure.title), gnuplot_text(figure.x_label),
      gnuplot_text(figure.y_label), figure.log_x ? "set logscale x\n" : "");
  // Curves of one family share a colour; its first curve carries the label.
  int family = 0;
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    const Figure::Curve& curve = figure.curves[i];
    if (!curve.label.empty()) ++family;
    const char* colour = family % 2 == 1 ? "#c1440e" : "#1f5fa8";
    fmt::format_to(
        std::back_inserter(script), "{}\"{}.csv\" index {} using 1:2 with {} lc rgb \"{}\" {}",
        i == 0 ? "" : ", \\\n  ", figure.name, i, curve.marks ? "points pt 7 ps 1.2" : "lines lw 2",
        colour,
        curve.label.empty() ? "notitle" : fmt::format("title \"{}\"", gnuplot_text(curve.label)));
  }
  return script + "\n";
}

std::string table_of(const Figure& figure) {
  std::string text = fmt::format("# {},{}\n", figure.x_label, figure.y_label);
  for (const Figure::Curve& curve : figure.curves) {
    fmt::format_to(std::back_inserter(text), "# {}\n", curve.label);
    for (const auto& [x, y] : curve.points) {
      fmt::format_to(std::back_inserter(text), "{:.6g},{:.6g}\n", x, y);
    }
    text += "\n\n";
  }
  return text;
}

nlohmann::ordered_json json_of(const Scenario& scenario, const Results& results) {
  nlohmann::ordered_json json{{"experiment", scenario.kind().name},
                              {"name", scenario.name()},
                              {"seed", scenario.seed()},
                              {"results", nlohmann::ordered_json::object()},
                              {"units", nlohmann::ordered_json::object()}};
  for (const Result& result : results) {
    json["results"][result.name] =
        result.value ? nlohmann::ordered_json(*result.value) : nlohmann::ordered_json();
    json["units"][result.name] = result.unit;
  }
  return json;
}

}  // namespace

std::vector<Override> overrides_of(const std::vector<std::string>& settings) {
  std::vector<Override> overrides;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw ConfigError{fmt::format("--set {}: must be KEY=VALUE", setting)};
    }
    overrides.push_back(
        {.key = setting.substr(0, equals), .value = setting.substr(equals + 1), .origin = "--set"});
  }
  return overrides;
}

void confirm_start(const ArmInfo& arm, const std::string& what, bool yes, bool force) {
  if (arm.simulated) return;
  if (yes && force) return;
  if (yes) {
    throw ConfigError{
        "--yes: a real arm starts only when somebody beside it says so; --force if nobody can"};
  }
  fmt::print(stderr,
             "{} ({}) will move by itself: {}. Hands off, everything out of its reach.\n"
             "Type yes to start: ",
             arm.name, arm.model, what);
  std::string answer;
  std::getline(std::cin, answer);
  if (answer != "yes") throw ConfigError{"not started: the answer was not yes"};
}

int run_scenario(const RunOptions& options) {
  if (options.scenario.empty()) return list_scenarios();
  const Scenario scenario{read_scenario(options.scenario), overrides_of(options.settings)};
  if (options.print) {
    std::fputs(scenario.settings().print().c_str(), stdout);
    return 0;
  }
  const fs::path folder = options.out.empty() ? fs::path{} : make_folder(options.out);
  ExperimentContext context;
  std::vector<Figure> figures;
  if (!folder.empty()) context.figures = &figures;

  SystemClock clock;
  std::unique_ptr<Arm> arm;
  std::optional<OpenArm> open;
  if (!scenario.simulated()) {
    arm = open_device(scenario.device(), {.clock = clock, .seed = scenario.seed()});
    confirm_start(arm->info(), std::string{scenario.kind().text}, options.yes, options.force);
    open.emplace(OpenArm{*arm, clock});
    context.arm = &*open;
  }
  std::atomic<bool> asked{false};
  context.stop = &asked;
  Results results;
  run_while_listening(asked, [&] { results = scenario.run(context); });
  if (asked) {
    std::fputs("stopped before the end: no results\n", stderr);
    return 1;
  }

  for (const Result& result : results) {
    const std::string value = result.value ? fmt::format("{:.6g}", *result.value) : "none";
    fmt::print("{:<26} {:>12}  {}\n", result.name, value, result.unit);
  }
  const nlohmann::ordered_json json = json_of(scenario, results);
  if (!options.json.empty()) write_json(options.json, json);
  bool drawn = true;
  if (!folder.empty()) {
    write_json(folder / "results.json", json);
    for (const Figure& figure : figures) {
      write_text(folder / (figure.name + ".csv"), table_of(figure));
      drawn = draw_with_gnuplot(folder, figure.name, script_of(figure)) && drawn;
    }
  }
  return has_fault(results) || !drawn ? 1 : 0;
}

}  // namespace teleop
