#pragma once

#include <array>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// Friction of one joint, all its effects summed. It opposes the motion:
///
///     f = −(dry_forward  + viscous_forward  q̇)   q̇ > 0
///     f = +(dry_backward − viscous_backward q̇)   q̇ < 0
///     f ∈ [−dry_forward, dry_backward]           q̇ = 0: whatever keeps the joint at rest
struct JointFriction {
  double dry_forward = 0.0;       ///< N m
  double dry_backward = 0.0;      ///< N m
  double viscous_forward = 0.0;   ///< N m s/rad
  double viscous_backward = 0.0;  ///< N m s/rad

  /// The law has a corner at rest, so a change of direction is an event.
  [[nodiscard]] constexpr bool has_corner() const noexcept {
    return dry_forward > 0.0 || dry_backward > 0.0 || viscous_forward != viscous_backward;
  }
};

/// What a list of effects adds to the rigid body, summed over the effects once and for all, so
/// that a step costs the same whatever the length of the list.
struct PlantTerms {
  std::array<JointFriction, kJoints> friction{};
};

}  // namespace teleop
