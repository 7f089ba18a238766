#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/experiment/sweep_plan.hpp"

namespace teleop {

/// The [sweep] table as it was read, values not yet spread over points.
struct SweepTable {
  struct Axis {
    SweepAxis axis{};  ///< its values where the file lists them
    bool range = false;
    double from = 0.0;
    double to = 0.0;
    std::int64_t points = 0;  ///< of the range, 0 not given
  };
  SweepPlan::Method method = SweepPlan::Method::grid;
  std::int64_t points = 0;  ///< of a Latin hypercube, 0 not given
  std::uint64_t seed = 1;   ///< of a Latin hypercube
  bool same_seed = false;   ///< every point has the scenario's seed
  std::vector<Axis> axes{};
  SweepRest rest{};
  std::string place{};
};

/// @throws ConfigError naming file and line: no [sweep], an unknown key, a wrong type, a range
///         without room, an axis without values.
[[nodiscard]] SweepTable read_sweep_table(const ScenarioText& text);

/// The value at share `u` of a range, 0 to 1, on its scale.
[[nodiscard]] double at_share(const SweepTable::Axis& axis, double u);

/// A number as the two texts, shortest that reads back the same.
[[nodiscard]] SweepValue sweep_value(double number);

}  // namespace teleop
