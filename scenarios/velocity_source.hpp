#pragma once

#include <vector>

#include "core/estimation/velocity_score.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/velocity.hpp"

namespace teleop {

/// What `teleop velocity` looks at.
struct VelocitySource {
  ArmModel arm;
  std::vector<VelocityTrace> traces{};
  bool has_truth = false;   ///< the reference is the simulated arm's own speed
  bool has_period = false;  ///< the period counter was read throughout
};

/// The recordings, or an arm's readings when there are none.
/// @throws ConfigError, DeviceError, RecordingError as run_velocity().
[[nodiscard]] VelocitySource load_velocity_source(const VelocityOptions& options);

}  // namespace teleop
