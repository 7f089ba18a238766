#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.hpp"
#include "core/experiment/experiment.hpp"

namespace teleop {

extern const ExperimentKind teleop_experiment;
extern const ExperimentKind gravity_experiment;
extern const ExperimentKind computed_torque_experiment;
extern const ExperimentKind virtual_wall_experiment;
extern const ExperimentKind marginal_gain_experiment;
extern const ExperimentKind frequency_response_experiment;
extern const ExperimentKind motor_heat_experiment;
extern const ExperimentKind probe_experiment;

namespace {

constexpr std::array kExperiments{
    &teleop_experiment,       &gravity_experiment,       &computed_torque_experiment,
    &virtual_wall_experiment, &marginal_gain_experiment, &frequency_response_experiment,
    &motor_heat_experiment,   &probe_experiment,
};

}  // namespace

std::span<const ExperimentKind* const> experiments() noexcept { return kExperiments; }

bool has_fault(const Results& results) {
  return std::any_of(results.begin(), results.end(), [](const Result& result) {
    return result.name.ends_with("fault") && result.value.value_or(0.0) != 0.0;
  });
}

const ExperimentKind& find_experiment(std::string_view name) {
  std::vector<std::string_view> names;
  for (const ExperimentKind* each : kExperiments) {
    if (each->name == name) return *each;
    names.push_back(each->name);
  }
  throw ConfigError{
      fmt::format("unknown experiment '{}'; allowed: {}", name, fmt::join(names, ", "))};
}

}  // namespace teleop
