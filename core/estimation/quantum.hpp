#pragma once

#include "core/math/joint_vector.hpp"

namespace teleop {

/// Angle of one encoder count of each joint, Δ = 2π / |counts_per_rev|, rad.
/// @throws ConfigError when a joint has no counts.
[[nodiscard]] JointVector encoder_quantum(const JointVector& counts_per_rev);

}  // namespace teleop
