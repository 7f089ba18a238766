#pragma once

#include <cmath>

#include "scenarios/concealed/plant.hpp"

namespace teleop::concealed {

/// The rigid body of one posture, from the Lagrangian with
///
///     M11 = S0 + S2 cos 2q2 − S3 cos 2q3 + K cos q2 sin q3,   M23 = −(K/2) sin(q2 − q3),
///     U = up · (sin q1 R, Y, cos q1 R),  R = N2 cos q2 + N3 sin q3,  Y = N2 sin q2 − N3 cos q3.
struct Plant::Body {
  double M11 = 0.0;
  double M22 = 0.0;
  double M33 = 0.0;
  double M23 = 0.0;
  double determinant = 0.0;
  double c2 = 1.0, s2 = 0.0, c3 = 1.0, s3 = 0.0;

  Body(const PlantLaw& law, const JointVector& q) noexcept
      : c2{std::cos(q[1])}, s2{std::sin(q[1])}, c3{std::cos(q[2])}, s3{std::sin(q[2])} {
    const ArmModel::Lumped& k = law.body;
    M11 = k.S0 + k.S2 * (1.0 - 2.0 * s2 * s2) - k.S3 * (1.0 - 2.0 * s3 * s3) + k.K * c2 * s3 +
          moved(law, 0);
    M22 = k.M22 + moved(law, 1);
    M33 = k.M33 + moved(law, 2);
    M23 = -k.K / 2.0 * (s2 * c3 - c2 * s3);
    determinant = M22 * M33 - M23 * M23;
  }

  /// Inertia that a law adds to an axis's link or takes from it.
  [[nodiscard]] static double moved(const PlantLaw& law, std::size_t i) noexcept {
    const AxisLaw& axis = law.axes[i];
    return axis.link.added_inertia - axis.link.absorber -
           (axis.transmission.split ? axis.transmission.rotor : 0.0);
  }

  [[nodiscard]] JointVector solve(const JointVector& torque) const noexcept {
    return {torque[0] / M11, (M33 * torque[1] - M23 * torque[2]) / determinant,
            (M22 * torque[2] - M23 * torque[1]) / determinant};
  }
  /// Column of M⁻¹.
  [[nodiscard]] JointVector column(std::size_t i) const noexcept {
    return solve(JointVector::Unit(static_cast<Eigen::Index>(i)));
  }

  /// C q̇ + N: d/dt ∂T/∂q̇ − ∂T/∂q with M q̈ left out, and the gradient of U.
  [[nodiscard]] JointVector bias(const PlantLaw& law,
                                 const JointVector& q,
                                 const JointVector& v) const noexcept {
    const ArmModel::Lumped& k = law.body;
    const double M11_by_2 = -4.0 * k.S2 * s2 * c2 - k.K * s2 * s3;
    const double M11_by_3 = 4.0 * k.S3 * s3 * c3 + k.K * c2 * c3;
    const double M23_by_2 = -k.K / 2.0 * (c2 * c3 + s2 * s3);
    JointVector sum{v[0] * (M11_by_2 * v[1] + M11_by_3 * v[2]),
                    -M23_by_2 * v[2] * v[2] - M11_by_2 * v[0] * v[0] / 2.0,
                    M23_by_2 * v[1] * v[1] - M11_by_3 * v[0] * v[0] / 2.0};
    double level = 0.0;  // of `up` in the arm's plane
    if (law.up[0] != 0.0 || law.up[2] != 0.0) {
      const double c1 = std::cos(q[0]);
      const double s1 = std::sin(q[0]);
      level = law.up[0] * s1 + law.up[2] * c1;
      sum[0] += (law.up[0] * c1 - law.up[2] * s1) * (k.N2 * c2 + k.N3 * s3);
    }
    sum[1] += k.N2 * (law.up[1] * c2 - level * s2);
    sum[2] += k.N3 * (law.up[1] * s3 + level * c3);
    return sum;
  }

  [[nodiscard]] double energy(const PlantLaw& law,
                              const JointVector& q,
                              const JointVector& v) const noexcept {
    const double kinetic =
        (M11 * v[0] * v[0] + M22 * v[1] * v[1] + M33 * v[2] * v[2]) / 2.0 + M23 * v[1] * v[2];
    const double forward = law.body.N2 * c2 + law.body.N3 * s3;
    const double height = law.body.N2 * s2 - law.body.N3 * c3;
    return kinetic +
           law.up.dot(JointVector{std::sin(q[0]) * forward, height, std::cos(q[0]) * forward});
  }
};

}  // namespace teleop::concealed
