#include "scenarios/workspace.hpp"

#include <cmath>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/model/workspace.hpp"
#include "scenarios/gnuplot.hpp"
#include "scenarios/output.hpp"
#include "scenarios/workspace_picture.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetres = 1000.0;

std::string table(const WorkspaceMap& map) {
  std::string text = "z_mm,y_mm,mu,reach\n";
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const Vector3 p = map.position(row, column);
      const WorkspaceCell& cell = map.cell(row, column);
      fmt::format_to(std::back_inserter(text), "{:.3f},{:.3f},{:.5f},{}\n", kMillimetres * p.z(),
                     kMillimetres * p.y(), cell.mu, text_of(cell.reach));
    }
  }
  return text;
}

nlohmann::json millimetres(const Vector3& p) {
  // Rounded to a nanometre, or the sums of grid steps show.
  const auto rounded = [](double metres) {
    return std::round(metres * 1e9) / 1e6;
  };
  return {rounded(p.x()), rounded(p.y()), rounded(p.z())};
}

nlohmann::json numbers(const ArmModel& arm, const WorkspaceMap& map) {
  nlohmann::json cells;
  for (std::size_t i = 0; i < map.counts.size(); ++i) {
    const auto reach = static_cast<Reach>(i);
    if (map.count(reach) > 0) cells[std::string{text_of(reach)}] = map.count(reach);
  }
  return {{"arm", arm.parameters().name},
          {"step_mm", kMillimetres * map.step_m},
          {"cells", cells},
          {"area_cm2", map.area_m2 * 1e4},
          {"extent_mm", {{"low", millimetres(map.lowest_m)}, {"high", millimetres(map.highest_m)}}},
          {"mu",
           {{"home", manipulability(arm, JointVector::Zero())},
            {"min", map.mu_min},
            {"p5", map.mu_quantiles[0]},
            {"p25", map.mu_quantiles[1]},
            {"p50", map.mu_quantiles[2]},
            {"p75", map.mu_quantiles[3]},
            {"p95", map.mu_quantiles[4]},
            {"max", map.mu_max},
            {"share_at_least_half", map.share_half}}}};
}

}  // namespace

int run_workspace(const WorkspaceOptions& options) {
  if (!std::isfinite(options.step_mm) || options.step_mm < 0.5 || options.step_mm > 50.0) {
    throw ConfigError{fmt::format("--step-mm {}: must be between 0.5 and 50", options.step_mm)};
  }
  const ArmModel arm = load_arm(options.arm);
  const WorkspaceMap map = map_workspace(arm, options.step_mm / kMillimetres);
  if (map.count(Reach::ok) == 0) {
    throw ConfigError{fmt::format(
        "{}: no grid point is within its stops: look at [limits], or take a smaller --step-mm",
        options.arm)};
  }
  const fs::path where = make_folder(options.out);

  write_text(where / "workspace.csv", table(map));
  const nlohmann::json json = numbers(arm, map);
  write_json(where / "workspace.json", json);
  if (!options.json.empty()) write_json(options.json, json);
  const bool drawn = draw_with_gnuplot(where, "workspace", workspace_picture(arm, map));

  fmt::print(
      "{}: {:.0f} cm² in the plane x = 0, mu from {:.2f} to {:.2f}, median {:.2f}, "
      "at least 0.5 over {:.0f} % of it\n",
      arm.parameters().name, map.area_m2 * 1e4, map.mu_min, map.mu_max, map.mu_quantiles[2],
      100.0 * map.share_half);
  fmt::print("{}\n", (where / (drawn ? "workspace.png" : "workspace.json")).string());
  return drawn ? 0 : 1;
}

}  // namespace teleop
