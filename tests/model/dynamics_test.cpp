#include "core/model/dynamics.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/model/kinematics.hpp"
#include "tests/model/postures.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::cases;
using testing::phantom;

/// dM/dt along q̇ by central differences, extrapolated: error of the fourth order in the step.
JointMatrix mass_matrix_rate(const JointVector& q, const JointVector& qd) {
  const auto slope = [&](double step) -> JointMatrix {
    return (mass_matrix(phantom(), q + step * qd) - mass_matrix(phantom(), q - step * qd)) /
           (2.0 * step);
  };
  constexpr double kStep = 1e-3;
  return (4.0 * slope(kStep) - slope(2.0 * kStep)) / 3.0;
}

JointMatrix with_printed_sign_of_c32(JointMatrix C) {
  C(2, 1) = -C(2, 1);
  return C;
}

double asymmetry(const JointMatrix& S) { return (S + S.transpose()).norm(); }

TEST(Dynamics, MassMatrixRateMinusTwiceCIsSkew) {
  Random random{21};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const JointVector qd = testing::random_vector(random, 1.0);
    const JointMatrix C = dynamics(phantom(), q, qd).C;
    ASSERT_LT(asymmetry(mass_matrix_rate(q, qd) - 2.0 * C), 1e-13);
  }
}

TEST(Dynamics, PrintedSignOfC32BreaksSkewSymmetry) {
  Random random{22};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    JointVector qd = testing::random_vector(random, 1.0);
    const double h = phantom().lumped().K / 2.0 * std::cos(q[1] - q[2]);
    if (std::abs(h * qd[1]) < 1e-7) continue;
    const JointMatrix C = with_printed_sign_of_c32(dynamics(phantom(), q, qd).C);
    ASSERT_GT(asymmetry(mass_matrix_rate(q, qd) - 2.0 * C), 1e-7);
  }
}

TEST(Dynamics, MassMatrixIsSymmetricAndPositiveDefinite) {
  Random random{23};
  for (int i = 0; i < cases(); ++i) {
    const JointMatrix M = mass_matrix(phantom(), testing::random_posture(random));
    ASSERT_EQ(M, M.transpose());
    ASSERT_GT(Eigen::SelfAdjointEigenSolver<JointMatrix>{M}.eigenvalues()[0], 1e-4);
  }
}

TEST(Dynamics, MassMatrixOfAnyArmWithPositiveParametersIsPositiveDefinite) {
  Random random{24};
  for (int i = 0; i < cases(); ++i) {
    ArmParameters any = phantom().parameters();
    for (double* value : {&any.l1_m, &any.l2_m, &any.l3_m, &any.ma_kg, &any.mc_kg, &any.mbe_kg,
                          &any.mdf_kg, &any.Ibase_kg_m2}) {
      *value = std::pow(10.0, random.uniform(-4.0, 1.0));
    }
    for (auto* inertia : {&any.Ia_kg_m2, &any.Ic_kg_m2, &any.Ibe_kg_m2, &any.Idf_kg_m2}) {
      for (double& value : *inertia) {
        value = std::pow(10.0, random.uniform(-6.0, 0.0));
      }
    }
    const JointMatrix M = mass_matrix(ArmModel{any}, testing::random_posture(random));
    ASSERT_EQ(Eigen::LLT<JointMatrix>{M}.info(), Eigen::Success) << M;
  }
}

TEST(Dynamics, ForwardAndInverseAreInverses) {
  Random random{25};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const JointVector qd = testing::random_vector(random, 20.0);
    const JointVector tau = testing::random_vector(random, 1.0);
    const JointVector qdd = forward_dynamics(phantom(), q, qd, tau);
    ASSERT_LT((inverse_dynamics(phantom(), q, qd, qdd) - tau).norm(), 1e-13 * (1.0 + tau.norm()));
    const auto [M, C, N] = dynamics(phantom(), q, qd);
    ASSERT_LT((M * qdd + C * qd + N - tau).norm(), 1e-13);
  }
}

TEST(Dynamics, GravityTorqueIsTheSlopeOfThePotentialEnergy) {
  Random random{26};
  constexpr double kStep = 1e-5;
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const JointVector direction = testing::random_vector(random, 1.0);
    const double slope = (potential_energy(phantom(), q + kStep * direction) -
                          potential_energy(phantom(), q - kStep * direction)) /
                         (2.0 * kStep);
    ASSERT_NEAR(gravity_torque(phantom(), q).dot(direction), slope, 1e-10);
  }
}

struct Swing {
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();
  double work = 0.0;  ///< done by the motors, J

  [[nodiscard]] double energy() const {
    return kinetic_energy(phantom(), q, qd) + potential_energy(phantom(), q);
  }
};

Swing operator+(const Swing& a, const Swing& b) {
  return {a.q + b.q, a.qd + b.qd, a.work + b.work};
}
Swing operator*(double s, const Swing& a) { return {s * a.q, s * a.qd, s * a.work}; }

/// Classical Runge–Kutta of the fourth order.
template <typename Rate>
Swing integrated(Swing x, double duration, double dt, const Rate& rate) {
  const int steps = static_cast<int>(std::lround(duration / dt));
  for (int i = 0; i < steps; ++i) {
    const double t = i * dt;
    const Swing k1 = rate(x, t);
    const Swing k2 = rate(x + 0.5 * dt * k1, t + 0.5 * dt);
    const Swing k3 = rate(x + 0.5 * dt * k2, t + 0.5 * dt);
    const Swing k4 = rate(x + dt * k3, t + dt);
    x = x + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

/// Properties that integrate cost thousands of model evaluations a case.
int few_cases() { return 1 + cases() / 100; }

TEST(Dynamics, FreeSwingKeepsItsEnergy) {
  Random random{27};
  const auto rate = [](const Swing& x, double) -> Swing {
    return {x.qd, forward_dynamics(phantom(), x.q, x.qd, JointVector::Zero()), 0.0};
  };
  for (int i = 0; i < few_cases(); ++i) {
    const Swing start{testing::random_allowed_posture(random), testing::random_vector(random, 5.0)};
    const Swing end = integrated(start, 1.0, 2e-4, rate);
    ASSERT_NEAR(end.energy(), start.energy(), 1e-9);
  }
}

TEST(Dynamics, MotorsPutInExactlyTheEnergyThatTheArmGains) {
  Random random{28};
  for (int i = 0; i < few_cases(); ++i) {
    const JointVector amplitude = testing::random_vector(random, 0.05);
    const double omega = random.uniform(5.0, 60.0);
    const auto rate = [&](const Swing& x, double t) -> Swing {
      const JointVector tau = std::sin(omega * t) * amplitude;
      return {x.qd, forward_dynamics(phantom(), x.q, x.qd, tau), tau.dot(x.qd)};
    };
    const Swing start{testing::random_allowed_posture(random), testing::random_vector(random, 2.0)};
    const Swing end = integrated(start, 1.0, 2e-4, rate);
    ASSERT_NEAR(end.energy() - start.energy(), end.work, 1e-8);
  }
}

TEST(Dynamics, PrintedSignOfC32MakesAFreeSwingGainOrLoseATenthOfItsEnergy) {
  const auto rate = [](const Swing& x, double) -> Swing {
    const auto [M, C, N] = dynamics(phantom(), x.q, x.qd);
    const JointVector bias = with_printed_sign_of_c32(C) * x.qd + N;
    return {x.qd, M.llt().solve(-bias), 0.0};
  };
  const Swing start{JointVector::Zero(), {1.0, -4.0, 3.0}};
  const Swing end = integrated(start, 0.1, 2e-4, rate);
  const double drift = std::abs(end.energy() - start.energy());
  EXPECT_GT(drift, 0.05 * kinetic_energy(phantom(), start.q, start.qd));
}

TEST(Dynamics, ToolMassMakesTheKineticEnergyOfTheToolsMotion) {
  Random random{29};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_allowed_posture(random);
    if (manipulability(phantom(), q) < 1e-3) continue;
    const JointVector qd = testing::random_vector(random, 1.0);
    const Vector3 v = linear_jacobian(phantom(), q) * qd;
    const auto mass = tool_mass(phantom(), q);
    const double energy = v.dot(mass.value_or(Matrix3::Zero()) * v) / 2.0;
    ASSERT_NEAR(energy, kinetic_energy(phantom(), q, qd), 1e-9 * energy);
  }
}

TEST(Dynamics, IsFiniteAtSingularPosturesWhereThereIsNoToolMass) {
  const double right_angle = std::numbers::pi / 2.0;
  const JointVector stretched{0.3, -0.4, right_angle - 0.4};
  const JointVector folded{0.3, 0.4, 0.4 - right_angle};
  const JointVector on_axis{0.3, std::acos(-0.170 / 0.215 * std::sin(1.0)), 1.0};
  const JointVector qd{1.0, 2.0, 3.0};
  for (const JointVector& q : {stretched, folded, on_axis}) {
    EXPECT_FALSE(tool_mass(phantom(), q));
    EXPECT_TRUE(forward_dynamics(phantom(), q, qd, qd).allFinite());
    EXPECT_TRUE(inverse_dynamics(phantom(), q, qd, qd).allFinite());
  }
}

TEST(Dynamics, RunsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const ArmModel& arm = phantom();
  const JointVector q{0.1, 0.2, 0.3};
  const Matrix3 M = Matrix3::Zero();
  double sum = 0.0;

  const testing::NoAllocation guard;
  sum += dynamics(arm, q, q).C.sum() + mass_matrix(arm, q).sum() + gravity_torque(arm, q).sum();
  sum += inverse_dynamics(arm, q, q, q).sum() + forward_dynamics(arm, q, q, q).sum();
  sum += kinetic_energy(arm, q, q) + potential_energy(arm, q) + tool_mass(arm, q).value_or(M).sum();

  EXPECT_EQ(guard.count(), 0U) << sum;
}

}  // namespace
}  // namespace teleop
