#pragma once

#include <optional>

#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// M(q) q̈ + C(q, q̇) q̇ + N(q) = τ, with C in Christoffel form so that Ṁ − 2C is skew
/// [Cavusoglu 2002, section 3, with the errata in docs/theory.md].
struct Dynamics {
  JointMatrix M = JointMatrix::Zero();
  JointMatrix C = JointMatrix::Zero();
  JointVector N = JointVector::Zero();
};

/// Loop: allocation-free, noexcept, like everything in this file.
[[nodiscard]] Dynamics dynamics(const ArmModel& arm,
                                const JointVector& q,
                                const JointVector& qd) noexcept;
[[nodiscard]] JointMatrix mass_matrix(const ArmModel& arm, const JointVector& q) noexcept;
/// N(q): the torque that holds the arm against gravity.
[[nodiscard]] JointVector gravity_torque(const ArmModel& arm, const JointVector& q) noexcept;
[[nodiscard]] JointVector inverse_dynamics(const ArmModel& arm,
                                           const JointVector& q,
                                           const JointVector& qd,
                                           const JointVector& qdd) noexcept;
[[nodiscard]] JointVector forward_dynamics(const ArmModel& arm,
                                           const JointVector& q,
                                           const JointVector& qd,
                                           const JointVector& tau) noexcept;
[[nodiscard]] double kinetic_energy(const ArmModel& arm,
                                    const JointVector& q,
                                    const JointVector& qd) noexcept;
[[nodiscard]] double potential_energy(const ArmModel& arm, const JointVector& q) noexcept;

/// Λ = (J_v M⁻¹ J_vᵀ)⁻¹ in B: the mass that a hand feels at the tool, kg. Absent at a singular
/// posture (manipulability below 1e-9), where some direction cannot be moved at all.
[[nodiscard]] std::optional<Matrix3> tool_mass(const ArmModel& arm, const JointVector& q) noexcept;

}  // namespace teleop
