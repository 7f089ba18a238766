#include "core/model/dynamics.hpp"

#include <cmath>

#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

/// What M, C and N share: every trigonometric function of a posture, evaluated once.
struct Terms {
  double M11 = 0.0;
  double M23 = 0.0;
  double a = 0.0;  ///< ∂M11/∂q2 / 2
  double b = 0.0;  ///< ∂M11/∂q3 / 2
  double h = 0.0;  ///< −∂M23/∂q2 = ∂M23/∂q3
  double N2 = 0.0;
  double N3 = 0.0;

  Terms(const ArmModel::Lumped& arm, const JointVector& q) noexcept {
    const double c2 = std::cos(q[1]);
    const double s2 = std::sin(q[1]);
    const double c3 = std::cos(q[2]);
    const double s3 = std::sin(q[2]);
    M11 =
        arm.S0 + arm.S2 * (c2 - s2) * (c2 + s2) - arm.S3 * (c3 - s3) * (c3 + s3) + arm.K * c2 * s3;
    M23 = -arm.K / 2.0 * (s2 * c3 - c2 * s3);
    a = -s2 * (2.0 * arm.S2 * c2 + arm.K / 2.0 * s3);
    b = c3 * (2.0 * arm.S3 * s3 + arm.K / 2.0 * c2);
    h = arm.K / 2.0 * (c2 * c3 + s2 * s3);
    N2 = arm.N2 * c2;
    N3 = arm.N3 * s3;
  }

  /// C(q, q̇) q̇ + N(q)
  [[nodiscard]] JointVector bias(const JointVector& qd) const noexcept {
    return {2.0 * qd[0] * (a * qd[1] + b * qd[2]),        //
            -a * qd[0] * qd[0] + h * qd[2] * qd[2] + N2,  //
            -b * qd[0] * qd[0] - h * qd[1] * qd[1] + N3};
  }
};

JointMatrix assemble(const ArmModel::Lumped& arm, const Terms& t) noexcept {
  JointMatrix M;
  M << t.M11, 0.0, 0.0,     //
      0.0, arm.M22, t.M23,  //
      0.0, t.M23, arm.M33;
  return M;
}

}  // namespace

Dynamics dynamics(const ArmModel& arm, const JointVector& q, const JointVector& qd) noexcept {
  const Terms t{arm.lumped(), q};
  Dynamics result;
  result.M = assemble(arm.lumped(), t);
  result.C << t.a * qd[1] + t.b * qd[2], t.a * qd[0], t.b * qd[0],  //
      -t.a * qd[0], 0.0, t.h * qd[2],                               //
      -t.b * qd[0], -t.h * qd[1], 0.0;
  result.N << 0.0, t.N2, t.N3;
  return result;
}

JointMatrix mass_matrix(const ArmModel& arm, const JointVector& q) noexcept {
  return assemble(arm.lumped(), Terms{arm.lumped(), q});
}

JointVector gravity_torque(const ArmModel& arm, const JointVector& q) noexcept {
  return {0.0, arm.lumped().N2 * std::cos(q[1]), arm.lumped().N3 * std::sin(q[2])};
}

JointVector inverse_dynamics(const ArmModel& arm,
                             const JointVector& q,
                             const JointVector& qd,
                             const JointVector& qdd) noexcept {
  const Terms t{arm.lumped(), q};
  const JointVector M_qdd{t.M11 * qdd[0], arm.lumped().M22 * qdd[1] + t.M23 * qdd[2],
                          t.M23 * qdd[1] + arm.lumped().M33 * qdd[2]};
  return M_qdd + t.bias(qd);
}

JointVector forward_dynamics(const ArmModel& arm,
                             const JointVector& q,
                             const JointVector& qd,
                             const JointVector& tau) noexcept {
  const Terms t{arm.lumped(), q};
  const JointVector net = tau - t.bias(qd);
  const ArmModel::Lumped& lumped = arm.lumped();
  const double determinant = lumped.M22 * lumped.M33 - t.M23 * t.M23;
  return {net[0] / t.M11,  //
          (lumped.M33 * net[1] - t.M23 * net[2]) / determinant,
          (lumped.M22 * net[2] - t.M23 * net[1]) / determinant};
}

double kinetic_energy(const ArmModel& arm, const JointVector& q, const JointVector& qd) noexcept {
  return qd.dot(mass_matrix(arm, q) * qd) / 2.0;
}

double potential_energy(const ArmModel& arm, const JointVector& q) noexcept {
  return arm.lumped().N2 * std::sin(q[1]) - arm.lumped().N3 * std::cos(q[2]);
}

std::optional<Matrix3> tool_mass(const ArmModel& arm, const JointVector& q) noexcept {
  constexpr double kSingular = 1e-9;
  if (manipulability(arm, q) < kSingular) return std::nullopt;
  const Matrix3 inverse = linear_jacobian(arm, q).inverse();
  return inverse.transpose() * mass_matrix(arm, q) * inverse;
}

}  // namespace teleop
