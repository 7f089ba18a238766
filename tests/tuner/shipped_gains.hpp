#pragma once

#include <cstddef>

#include "core/control/position_error.hpp"
#include "core/math/joint_vector.hpp"
#include "scenarios/tune.hpp"

namespace teleop::testing {

/// Where two shipped arms, tied by the shipped law, bear the least, as the tuner found it over
/// kGridPoses poses and all axes (docs/theory.md).
struct WorstPose {
  JointVector q{0.0, 0.434962, 1.181681};
  std::size_t axis = 0;
  double gain_N_per_m = 2643.0;
};
inline constexpr int kGridPoses = 300;

/// The tuner's defaults, the shipped estimator and damping. The motion of the other arm is one
/// sample old, as two loops that are not synchronised see it at worst.
inline TuneOptions shipped_pair() {
  TuneOptions options;
  options.experiment = "teleop";
  options.axis = "all";
  options.damping_Ns_per_m = PositionError::Config{}.damping_slave_Ns_per_m;
  options.peer_delay_samples = 1;
  return options;
}

}  // namespace teleop::testing
