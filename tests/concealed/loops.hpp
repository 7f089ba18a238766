#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/model/arm_model.hpp"
#include "core/model/dynamics.hpp"
#include "scenarios/concealed/plant.hpp"

namespace teleop::concealed::testing {

inline const ArmModel& phantom() {
  static const ArmModel shipped = load_arm("phantom-1.5");
  return shipped;
}

inline Effect on(std::size_t axis,
                 const char* kind,
                 std::vector<std::pair<std::string, double>> p) {
  return {.kind = kind, .axis = axis, .parameters = std::move(p)};
}
inline Effect whole(const char* kind, std::vector<std::pair<std::string, double>> p) {
  return {.kind = kind, .axis = std::nullopt, .parameters = std::move(p)};
}

inline Plant plant_with(const std::vector<Effect>& effects,
                        int substeps = 40,
                        const JointVector& v = {0.2, -0.1, 0.15}) {
  return {plant_law(phantom(), effects, 7), {0.1, 0.45, 0.2}, v, substeps};
}

/// A torque that moves all joints about the middle of the workspace.
inline JointVector excitation(int tick, const JointVector& q, const JointVector& qd) {
  const double t = 1e-3 * tick;
  const JointVector push{0.03 * std::sin(9.0 * t) + 0.012 * std::sin(61.0 * t),
                         0.03 * std::sin(8.0 * t + 1.0) + 0.010 * std::sin(83.0 * t),
                         0.02 * std::sin(10.0 * t + 2.0) + 0.007 * std::sin(71.0 * t)};
  const JointVector off = q - JointVector{0.0, 0.40, 0.25};
  return push + gravity_torque(phantom(), q) - 0.25 * off - 0.012 * qd;
}

}  // namespace teleop::concealed::testing
