#pragma once

#include "core/math/joint_vector.hpp"

namespace teleop {

/// What shakes an arm and its readings although no physics is missing, per axis: a white torque,
/// held over each sample; a coloured one, d(k+1) = φ d(k) + sqrt(1 − φ²) σ ξ with φ = exp(−period /
/// time constant); and the noise of the readings, quantisation included.
struct NoiseModel {
  JointVector white = JointVector::Constant(4e-4);          ///< standard deviation, N m
  JointVector coloured = JointVector::Constant(6e-4);       ///< standard deviation, N m
  JointVector time_constant = JointVector::Constant(0.03);  ///< s
  JointVector reading = JointVector::Constant(4e-5);        ///< standard deviation, rad
};

}  // namespace teleop
