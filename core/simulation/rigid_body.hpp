#pragma once

#include <cmath>

#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// The arm's equations of core/model evaluated together at one state, each sine and cosine once:
/// an integrator asks for all of them several times a step. A mass m at the tool without weight,
/// such as a hand's, is taken into the lumped constants: it adds m JᵀJ to M, which is
///
///     M11 += m ρ²,  M22 += m l1²,  M33 += m l2²,  M23 −= m l1 l2 sin(q2 − q3),
///
/// the very form of [Cavusoglu 2002, section 3], and its Christoffel terms follow. A payload is
/// such a mass with weight. The base may be tilted: with up = Rx(tilt_x) Rz(tilt_z) e_y the
/// weight's energy is
///
///     U = (up_x sin q1 + up_z cos q1)(N2 cos q2 + N3 sin q3) + up_y (N2 sin q2 − N3 cos q3).
///
/// Loop: allocation-free, noexcept.
class RigidBody {
 public:
  /// @param tool_mass_kg moves with the tool and has no weight
  explicit RigidBody(const ArmModel& arm, double tool_mass_kg = 0.0, const LoadTerms& load = {})
      : l1_{arm.parameters().l1_m},
        l2_{arm.parameters().l2_m},
        lumped_{arm.lumped()},
        added_{load.added_inertia[0], load.added_inertia[1], load.added_inertia[2]},
        tilted_{load.tilt_x != 0.0 || load.tilt_z != 0.0},
        up_{-std::sin(load.tilt_z), std::cos(load.tilt_z) * std::cos(load.tilt_x),
            std::cos(load.tilt_z) * std::sin(load.tilt_x)} {
    const double m = tool_mass_kg + load.payload_kg;
    const double g = arm.parameters().gravity_m_per_s2;
    lumped_.N2 += load.payload_kg * g * l1_;
    lumped_.N3 += load.payload_kg * g * l2_;
    lumped_.K += 2.0 * m * l1_ * l2_;
    lumped_.S0 += m * (l1_ * l1_ + l2_ * l2_) / 2.0;
    lumped_.S2 += m * l1_ * l1_ / 2.0;
    lumped_.S3 += m * l2_ * l2_ / 2.0;
    lumped_.M22 += m * l1_ * l1_;
    lumped_.M33 += m * l2_ * l2_;
  }

  /// Sines and cosines of a posture.
  struct Angles {
    double c1 = 1.0, s1 = 0.0, c2 = 1.0, s2 = 0.0, c3 = 1.0, s3 = 0.0;

    Angles() = default;
    explicit Angles(const JointVector& q) noexcept
        : c1{std::cos(q[0])},
          s1{std::sin(q[0])},
          c2{std::cos(q[1])},
          s2{std::sin(q[1])},
          c3{std::cos(q[2])},
          s3{std::sin(q[2])} {}

    /// The same at q + by: for turns as small as those within a step by the angle sums with series,
    /// to the last digit but one and in a third of the time.
    [[nodiscard]] Angles turned(const JointVector& by) const noexcept {
      Angles at;
      turn(by[0], c1, s1, at.c1, at.s1);
      turn(by[1], c2, s2, at.c2, at.s2);
      turn(by[2], c3, s3, at.c3, at.s3);
      return at;
    }

   private:
    static void turn(double by, double c, double s, double& c_at, double& s_at) noexcept {
      const double x = by * by;
      double cosine = 1.0 - x * (0.5 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x / 40320.0)));
      double sine = by * (1.0 - x * (1.0 / 6.0 - x * (1.0 / 120.0 - x / 5040.0)));
      constexpr double kSmall = 0.05;  // the next terms are below 1e-17 there
      if (x > kSmall * kSmall) {
        cosine = std::cos(by);
        sine = std::sin(by);
      }
      c_at = c * cosine - s * sine;
      s_at = s * cosine + c * sine;
    }
  };

  /// M = [M11 0 0; 0 M22 M23; 0 M23 M33] and C q̇ + N.
  struct Inertia {
    double M11 = 0.0;
    double M22 = 0.0;
    double M33 = 0.0;
    double M23 = 0.0;
    JointVector bias = JointVector::Zero();
  };

  [[nodiscard]] Inertia inertia(const Angles& at, const JointVector& qd) const noexcept {
    const auto& [c1, s1, c2, s2, c3, s3] = at;
    const Lumped& k = lumped_;
    const double half_K = k.K / 2.0;
    const double a = -s2 * (2.0 * k.S2 * c2 + half_K * s3);
    const double b = c3 * (2.0 * k.S3 * s3 + half_K * c2);
    const double h = half_K * (c2 * c3 + s2 * s3);
    Inertia body;
    body.M11 = added_[0] + k.S0 + k.S2 * (c2 - s2) * (c2 + s2) - k.S3 * (c3 - s3) * (c3 + s3) +
               k.K * c2 * s3;
    body.M22 = k.M22 + added_[1];
    body.M33 = k.M33 + added_[2];
    body.M23 = -half_K * (s2 * c3 - c2 * s3);
    body.bias = {2.0 * qd[0] * (a * qd[1] + b * qd[2]),
                 h * qd[2] * qd[2] - a * qd[0] * qd[0] + k.N2 * c2,
                 -b * qd[0] * qd[0] - h * qd[1] * qd[1] + k.N3 * s3};
    if (tilted_) body.bias += tilt(at);
    return body;
  }

  struct Tool {
    Vector3 p = Vector3::Zero();
    Vector3 v = Vector3::Zero();
  };

  [[nodiscard]] Tool tool(const Angles& at, const JointVector& qd) const noexcept {
    const double rho = l1_ * at.c2 + l2_ * at.s3;
    const double across = rho * qd[0];
    const double outward = l2_ * at.c3 * qd[2] - l1_ * at.s2 * qd[1];
    return {.p = {at.s1 * rho, l2_ - l2_ * at.c3 + l1_ * at.s2, at.c1 * rho - l1_},
            .v = {at.c1 * across + at.s1 * outward, l1_ * at.c2 * qd[1] + l2_ * at.s3 * qd[2],
                  at.c1 * outward - at.s1 * across}};
  }

  /// Acceleration of the tool, J_v q̈ + J̇_v q̇.
  [[nodiscard]] Vector3 tool_acceleration(const Angles& at,
                                          const JointVector& qd,
                                          const JointVector& qdd) const noexcept {
    const double rho = l1_ * at.c2 + l2_ * at.s3;
    const double rho_rate = l2_ * at.c3 * qd[2] - l1_ * at.s2 * qd[1];
    const double rho_bend = l2_ * (at.c3 * qdd[2] - at.s3 * qd[2] * qd[2]) -
                            l1_ * (at.s2 * qdd[1] + at.c2 * qd[1] * qd[1]);
    const double across = rho * qdd[0] + 2.0 * qd[0] * rho_rate;
    const double outward = rho_bend - rho * qd[0] * qd[0];
    return {at.c1 * across + at.s1 * outward,
            l1_ * (at.c2 * qdd[1] - at.s2 * qd[1] * qd[1]) +
                l2_ * (at.s3 * qdd[2] + at.c3 * qd[2] * qd[2]),
            at.c1 * outward - at.s1 * across};
  }

  /// J_vᵀ f
  [[nodiscard]] JointVector torque(const Angles& at, const Vector3& f) const noexcept {
    const double outward = at.s1 * f.x() + at.c1 * f.z();
    return {(l1_ * at.c2 + l2_ * at.s3) * (at.c1 * f.x() - at.s1 * f.z()),
            l1_ * (at.c2 * f.y() - at.s2 * outward), l2_ * (at.c3 * outward + at.s3 * f.y())};
  }

  /// Kinetic energy and energy of weight, J.
  [[nodiscard]] double energy(const Angles& at, const JointVector& qd) const noexcept {
    const Inertia body = inertia(at, qd);
    const double kinetic =
        (body.M11 * qd[0] * qd[0] + body.M22 * qd[1] * qd[1] + body.M33 * qd[2] * qd[2]) / 2.0 +
        body.M23 * qd[1] * qd[2];
    const double lean = up_.x() * at.s1 + up_.z() * at.c1;
    return kinetic + lean * (lumped_.N2 * at.c2 + lumped_.N3 * at.s3) +
           up_.y() * (lumped_.N2 * at.s2 - lumped_.N3 * at.c3);
  }

 private:
  /// What a tilt changes of the torques of weight.
  [[nodiscard]] JointVector tilt(const Angles& at) const noexcept {
    const double lean = up_.x() * at.s1 + up_.z() * at.c1;
    const double turn = up_.x() * at.c1 - up_.z() * at.s1;
    const double less = up_.y() - 1.0;
    return {turn * (lumped_.N2 * at.c2 + lumped_.N3 * at.s3),
            lumped_.N2 * (less * at.c2 - lean * at.s2), lumped_.N3 * (less * at.s3 + lean * at.c3)};
  }

  using Lumped = ArmModel::Lumped;

  double l1_;
  double l2_;
  Lumped lumped_;
  JointVector added_;  ///< inertia, kg m²
  bool tilted_;
  Vector3 up_;  ///< in B
};

}  // namespace teleop
