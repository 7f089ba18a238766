#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/damping_limit.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/estimation/velocity_score.hpp"
#include "scenarios/velocity.hpp"
#include "scenarios/velocity_source.hpp"

namespace teleop {

/// One estimator beside the others.
struct VelocityRow {
  std::string name;  ///< "mean of 100"
  VelocityEstimator::Config config{};
  bool linear = false;                   ///< its damping is exact, not a describing function's
  std::optional<double> stated_lag_s{};  ///< of slow motion, when linear
  VelocityScore score{};
  std::vector<std::vector<Vector3>> estimates{};        ///< a trace each
  std::array<std::optional<DampingLimit>, 3> limits{};  ///< along x, y, z at home; absent: none
};

/// The loop in which the largest damping is looked for, along x, y and z at home.
struct DampingLoop {
  std::array<SampledMass, 3> mass{};
  std::array<double, 3> lever_m{};         ///< of the joint that moves the axis
  std::array<double, 3> amplitude_m{};     ///< of the oscillation at the margin
  std::array<double, 3> counts_per_rev{};  ///< of that joint
};

struct VelocityStudy {
  VelocitySource source;
  DampingLoop loop{};
  std::vector<VelocityRow> rows{};
};

/// The estimators' settings after --set, as TOML that the stations take.
/// @throws ConfigError as study_velocity().
[[nodiscard]] std::string velocity_settings(const VelocityOptions& options);

/// Runs every estimator on the readings and looks for its largest damping.
/// @throws ConfigError when a setting is unknown or not usable.
[[nodiscard]] VelocityStudy study_velocity(const VelocityOptions& options);

}  // namespace teleop
