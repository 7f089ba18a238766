#pragma once

#include <array>
#include <numbers>

#include "core/effects/plant_terms.hpp"
#include "core/model/arm_model.hpp"

namespace teleop::testing {

/// Finest angle that an encoder of the arm sees, rad.
inline constexpr double kCount = 2.0 * std::numbers::pi / 54476.8;

inline const ArmModel& phantom() {
  static const ArmModel shipped = load_arm("phantom-1.5");
  return shipped;
}

/// Friction so dry on joints 2 and 3 that they stay where they are, and as given on joint 1.
inline PlantTerms only_yaw(const JointFriction& friction) {
  PlantTerms terms;
  terms.friction[0] = friction;
  for (std::size_t i = 1; i < kJoints; ++i) {
    terms.friction.at(i) = {.dry_forward = 10.0, .dry_backward = 10.0};
  }
  return terms;
}

/// Dry friction of the shipped plant, viscous likewise.
inline PlantTerms shipped_friction() {
  constexpr std::array kDry{0.0086, 0.0086, 0.0068};
  constexpr std::array kViscous{0.0515, 0.0515, 0.0322};
  PlantTerms terms;
  for (std::size_t i = 0; i < kJoints; ++i) {
    terms.friction.at(i) = {.dry_forward = kDry.at(i),
                            .dry_backward = kDry.at(i),
                            .viscous_forward = kViscous.at(i),
                            .viscous_backward = kViscous.at(i)};
  }
  return terms;
}

}  // namespace teleop::testing
