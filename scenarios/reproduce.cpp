#include "scenarios/reproduce.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scenarios/output.hpp"
#include "scenarios/paper_experiments.hpp"

namespace teleop {
namespace {

constexpr double kAgrees = 0.10;

std::vector<PaperRowId> wanted_rows(const std::vector<std::string>& ids) {
  std::vector<PaperRowId> rows;
  for (const PaperRowId row : kPaperRows) {
    if (ids.empty() || std::find(ids.begin(), ids.end(), text_of(row).id) != ids.end()) {
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<PaperRow> table(const std::vector<PaperRowId>& wanted,
                            const PaperSet& set,
                            bool quick) {
  std::vector<PaperRow> rows;
  for (const PaperRowId id : wanted) {
    const std::optional<double> value = analysed(id, set);
    if (quick && value) {
      rows.push_back(
          {.id = id, .ours = *value, .low = *value, .high = *value, .drive = "analysis"});
      continue;
    }
    fmt::print(stderr, "{} …\n", text_of(id).id);
    rows.push_back(do_experiment(id, set, StockDrive::lag));
  }
  return rows;
}

void print_table(const char* title, const std::vector<PaperRow>& rows, const PaperSet& set) {
  fmt::print("\n{}\n", title);
  fmt::print("{:<21} {:>7} {:>8} {:<5} {:>7}  {:<15} {}\n", "row", "paper", "ours", "unit", "error",
             "status", "drive");
  for (const PaperRow& row : rows) {
    const PaperRowText text = text_of(row.id);
    const bool found = row.ours > 0.0;
    fmt::print("{:<21} {:>7.4g} {:>8} {:<5} {:>7}  {:<15} {}{}\n", text.id, text.paper,
               found ? fmt::format("{:.4g}", row.ours) : "none", text.unit,
               found ? fmt::format("{:+.1f}%", 100.0 * (row.ours / text.paper - 1.0)) : "",
               status_of(row.id, row.ours, set), row.drive,
               row.note.empty() ? "" : " (" + row.note + ")");
  }
}

void print_parameters(const PaperSet& set) {
  fmt::print("\nWhat was assumed, and by how many percent a row moves with one percent of it\n");
  fmt::print("{:<19} {:>9} {:<8}", "parameter", "value", "unit");
  for (const PaperRowId row : kPaperRows) {
    if (has_analysis(row)) fmt::print(" {:>15}", text_of(row).id);
  }
  fmt::print("  source\n");
  for (std::size_t i = 0; i < PaperSet::count; ++i) {
    const auto index = static_cast<PaperSet::Index>(i);
    const PaperParameter& parameter = set.parameters.at(i);
    fmt::print("{:<19} {:>9.4g} {:<8}", parameter.name, parameter.value, parameter.unit);
    for (const PaperRowId row : kPaperRows) {
      if (!has_analysis(row)) continue;
      const double by = sensitivity(row, set, index);
      fmt::print(" {:>15}", std::abs(by) < 0.005 ? "·" : fmt::format("{:+.2f}", by));
    }
    fmt::print("  {}{}\n", parameter.source,
               parameter.fitted_to.empty()
                   ? ""
                   : fmt::format("; fitted to {}", fmt::join(parameter.fitted_to, ", ")));
  }
}

nlohmann::json json_of(const std::vector<PaperRow>& rows, const PaperSet& set) {
  nlohmann::json list = nlohmann::json::array();
  for (const PaperRow& row : rows) {
    const PaperRowText text = text_of(row.id);
    nlohmann::json sensitivities;
    for (std::size_t i = 0; i < PaperSet::count; ++i) {
      const double by = sensitivity(row.id, set, static_cast<PaperSet::Index>(i));
      if (by != 0.0) sensitivities[set.parameters.at(i).name] = by;
    }
    const bool found = row.ours > 0.0;
    const auto number = [&](double x) {
      return found ? nlohmann::json(x) : nlohmann::json();
    };
    list.push_back({{"id", text.id},
                    {"what", text.what},
                    {"paper", text.paper},
                    {"ours", number(row.ours)},
                    {"low", number(row.low)},
                    {"high", number(row.high)},
                    {"unit", text.unit},
                    {"status", status_of(row.id, row.ours, set)},
                    {"relative_error", number(row.ours / text.paper - 1.0)},
                    {"drive", row.drive},
                    {"note", row.note},
                    {"sensitivity", sensitivities}});
  }
  return list;
}

}  // namespace

std::string status_of(PaperRowId row, double ours, const PaperSet& set) {
  const PaperRowText text = text_of(row);
  const bool agrees = std::abs(ours / text.paper - 1.0) <= kAgrees;
  if (!agrees) return "not_reproduced";
  for (const PaperParameter& parameter : set.parameters) {
    const auto& by = parameter.fitted_to;
    if (std::find(by.begin(), by.end(), text.id) != by.end()) return "fitted";
  }
  return "predicted";
}

double sensitivity(PaperRowId row, const PaperSet& set, PaperSet::Index parameter) {
  if (!has_analysis(row)) return 0.0;
  constexpr double kStep = 0.02;
  const PaperParameter& middle = set.parameters.at(parameter);
  const auto with = [&](double value) {
    PaperSet moved = set;
    moved.parameters.at(parameter).value = value;
    return std::log(*analysed(row, moved));
  };
  if (middle.value == 0.0) {
    return 100.0 * (with(0.1 * middle.high) - with(0.0));
  }
  return (with(middle.value * (1.0 + kStep)) - with(middle.value * (1.0 - kStep))) /
         (std::log1p(kStep) - std::log1p(-kStep));
}

int run_reproduce(const ReproduceOptions& options) {
  const PaperSet set = options.fit ? fit_paper_set(declared_paper_set()) : declared_paper_set();
  const std::vector<PaperRowId> wanted = wanted_rows(options.rows);
  const std::vector<PaperRow> each = table(wanted, set, options.quick);
  print_table("Each row with the drive model that it needs", each, set);

  std::vector<PaperRow> one;
  std::vector<PaperRow> structure;
  if (!options.quick) {
    one = each;
    for (PaperRow& row : one) {
      const bool stock = row.id == PaperRowId::wall_stock || row.id == PaperRowId::damping_100 ||
                         row.id == PaperRowId::loop_gain_ratio;
      if (!stock) continue;
      fmt::print(stderr, "{} with the voltage drive …\n", text_of(row.id).id);
      row = do_experiment(row.id, set, StockDrive::voltage);
    }
    print_table("The stock drive as one thing throughout: the PWM voltage that heats", one, set);
    const bool gains =
        std::find(wanted.begin(), wanted.end(), PaperRowId::loop_gain_ratio) != wanted.end();
    if (gains) {
      fmt::print(stderr, "loop gain with the structure of the x axis …\n");
      structure = {structural_loop_gain(set)};
      print_table("The loop-gain ratio once more, with the flexible x axis", structure, set);
    }
  }
  print_parameters(set);
  fmt::print("\nThe workspace map is drawn by: teleop workspace\n");

  if (!options.json.empty()) {
    nlohmann::json parameters = nlohmann::json::array();
    for (const PaperParameter& parameter : set.parameters) {
      parameters.push_back({{"name", parameter.name},
                            {"value", parameter.value},
                            {"unit", parameter.unit},
                            {"source", parameter.source},
                            {"fitted", !parameter.fitted_to.empty()},
                            {"fitted_to", parameter.fitted_to},
                            {"bounds", {parameter.low, parameter.high}}});
    }
    write_json(options.json, {{"rows", json_of(each, set)},
                              {"rows_one_drive", json_of(one, set)},
                              {"rows_structure", json_of(structure, set)},
                              {"parameters", parameters}});
  }
  return 0;
}

}  // namespace teleop
