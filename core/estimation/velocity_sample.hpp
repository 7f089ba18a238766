#pragma once

#include <array>
#include <cstdint>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// What a velocity estimator sees of one reading of an arm.
struct VelocitySample {
  JointVector q = JointVector::Zero();               ///< joint angles, rad
  std::array<std::int32_t, kJoints> period_ticks{};  ///< as in ArmState: 10 MHz ticks between the
                                                     ///< last two edges, sign = direction,
                                                     ///< 0 = overflow
  double dt = 0.0;                                   ///< since the sample before, measured, s
};

}  // namespace teleop
