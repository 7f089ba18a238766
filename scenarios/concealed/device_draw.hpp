#pragma once

#include <vector>

#include "core/math/random.hpp"
#include "scenarios/concealed/run.hpp"

namespace teleop::concealed {

/// How a device and its runs shall differ from the usual.
struct DeviceWish {
  double white = 1.0;  ///< of the disturbance's usual level
  double coloured = 1.0;
  double narrow_Nm = 0.0;      ///< RMS of a narrow-band disturbance on one axis
  bool encoder_noise = false;  ///< for certain, near one count
  bool inertia_edge = false;   ///< every inertia at an end of its tolerance
  double loop_gain = 1.0;      ///< of the controllers' bandwidth
  double motion = 1.0;         ///< size of the movements
  int substeps = 40;
  std::vector<Movement> movements{};  ///< of the six runs; empty: drawn
};

/// A device without effects, with six runs: inertias within 0.5 % of the nominal ones, noise,
/// controllers, movements and starts drawn.
[[nodiscard]] Device draw_device(const ArmModel& nominal, const DeviceWish& wish, Random& random);

}  // namespace teleop::concealed
