#pragma once

#include <array>
#include <cstddef>

#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/simulation/rigid_body.hpp"

namespace teleop {

/// What a joint does: friction is smooth while that stays.
enum class Sliding : signed char { backward = -1, stuck = 0, forward = 1 };
using SlidingModes = std::array<Sliding, kJoints>;

/// Accelerations under set-valued friction. Sliding joints feel the friction of their direction,
/// stuck ones whatever keeps them at rest:
///
///     M q̈ = net − f,   f_i = ±dry_i where i slides,   q̈_i = 0 and f_i = hold_i where it sticks.
struct Acceleration {
  JointVector qdd = JointVector::Zero();
  JointVector hold = JointVector::Zero();  ///< torque that friction takes up in stuck joints, N m
};

/// @param net torques of everything but dry friction, less C q̇ + N.
/// Loop: allocation-free, noexcept, like everything in this file.
[[nodiscard]] inline Acceleration accelerate(const RigidBody::Inertia& body,
                                             const std::array<JointFriction, kJoints>& friction,
                                             const JointVector& net,
                                             const SlidingModes& modes) noexcept {
  JointVector r = net;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    if (modes[i] == Sliding::forward) r[joint] -= friction[i].dry_forward;
    if (modes[i] == Sliding::backward) r[joint] += friction[i].dry_backward;
  }
  Acceleration result;
  if (modes[0] == Sliding::stuck) {
    result.hold[0] = r[0];
  } else {
    result.qdd[0] = r[0] / body.M11;
  }
  const bool stuck2 = modes[1] == Sliding::stuck;
  const bool stuck3 = modes[2] == Sliding::stuck;
  if (!stuck2 && !stuck3) {
    const double determinant = body.M22 * body.M33 - body.M23 * body.M23;
    result.qdd[1] = (body.M33 * r[1] - body.M23 * r[2]) / determinant;
    result.qdd[2] = (body.M22 * r[2] - body.M23 * r[1]) / determinant;
  } else {
    if (!stuck2) result.qdd[1] = r[1] / body.M22;
    if (!stuck3) result.qdd[2] = r[2] / body.M33;
    if (stuck2) result.hold[1] = r[1] - body.M23 * result.qdd[2];
    if (stuck3) result.hold[2] = r[2] - body.M23 * result.qdd[1];
  }
  return result;
}

/// The only modes that agree with themselves: a moving joint slides its way; one at rest slides
/// where its acceleration points, or sticks if friction can hold it. M is positive definite, so
/// exactly one combination does (the minimum of ½ q̈ᵀM q̈ − netᵀq̈ + Σ dry_i |q̈_i|); at the very
/// level, rounding apart, a joint sticks. Joints whose friction has no corner slide forward.
[[nodiscard]] SlidingModes resolve_friction(const RigidBody::Inertia& body,
                                            const std::array<JointFriction, kJoints>& friction,
                                            const JointVector& qd,
                                            const JointVector& net) noexcept;

}  // namespace teleop
