#include "core/model/kinematics.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "tests/model/postures.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using std::numbers::pi;
using testing::cases;
using testing::phantom;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kBranches{IkBranch::up, IkBranch::down, IkBranch::flip_up,
                               IkBranch::flip_down};

double degrees(double angle) { return angle * pi / 180.0; }

JointVector degrees(double q1, double q2, double q3) {
  return {degrees(q1), degrees(q2), degrees(q3)};
}

TEST(Kinematics, ToolIsAtTheOriginAtHome) {
  const Pose X_BT = forward_kinematics(phantom(), JointVector::Zero());
  EXPECT_EQ(X_BT.p, Vector3::Zero());
  EXPECT_EQ(X_BT.R, Matrix3::Identity());
}

TEST(Kinematics, JacobiansAreTheDerivativesOfThePose) {
  Random random{11};
  constexpr double kStep = 1e-6;
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const JointVector qd = testing::random_vector(random, 1.0);
    const Pose X_BT = forward_kinematics(phantom(), q);
    const Pose ahead = forward_kinematics(phantom(), q + kStep * qd);
    const Pose behind = forward_kinematics(phantom(), q - kStep * qd);
    const Vector3 v = (ahead.p - behind.p) / (2.0 * kStep);
    const Matrix3 spin = (ahead.R - behind.R) / (2.0 * kStep) * X_BT.R.transpose();
    Eigen::Matrix<double, 6, 1> V;
    V << v, spin(2, 1), spin(0, 2), spin(1, 0);

    ASSERT_LT((hybrid_jacobian(phantom(), q) * qd - V).norm(), 1e-9);
    ASSERT_LT((linear_jacobian(phantom(), q) * qd - v).norm(), 1e-9);
    V << X_BT.R.transpose() * V.head<3>(), X_BT.R.transpose() * V.tail<3>();
    ASSERT_LT((body_jacobian(phantom(), q) * qd - V).norm(), 1e-9);
  }
}

TEST(Kinematics, LinearJacobianRateIsTheDerivativeOfTheLinearJacobian) {
  Random random{12};
  constexpr double kStep = 1e-6;
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const JointVector qd = testing::random_vector(random, 1.0);
    const Matrix3 difference =
        (linear_jacobian(phantom(), q + kStep * qd) - linear_jacobian(phantom(), q - kStep * qd)) /
        (2.0 * kStep);
    ASSERT_LT((linear_jacobian_rate(phantom(), q, qd) - difference).norm(), 1e-9);
  }
}

TEST(Kinematics, ManipulabilityIsTheRatioOfTheSingularValues) {
  Random random{13};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_posture(random);
    const Vector3 sigma = Eigen::JacobiSVD<Matrix3>{linear_jacobian(phantom(), q)}.singularValues();
    ASSERT_NEAR(manipulability(phantom(), q), sigma[2] / sigma[0], 1e-14);
  }
}

TEST(Kinematics, ManipulabilityIsZeroWhereTheArmIsSingularAndKnownAtHome) {
  EXPECT_NEAR(manipulability(phantom(), JointVector::Zero()), 0.170 / 0.215, 1e-15);
  EXPECT_NEAR(manipulability(phantom(), degrees(0.0, -30.0, 60.0)), 0.0, 1e-15) << "stretched";
  EXPECT_NEAR(manipulability(phantom(), degrees(0.0, 60.0, -30.0)), 0.0, 1e-15) << "folded";
  const double q2 = std::acos(-0.170 / 0.215 * std::sin(degrees(60.0)));
  EXPECT_NEAR(manipulability(phantom(), {0.0, q2, degrees(60.0)}), 0.0, 1e-15) << "on the axis";
}

TEST(InverseKinematics, RecoversEveryPostureThatTheStopsAllow) {
  Random random{14};
  for (int i = 0; i < cases(); ++i) {
    const JointVector q = testing::random_allowed_posture(random);
    const Vector3 p = tool_position(phantom(), q);
    const bool behind_axis = phantom().parameters().l1_m * std::cos(q[1]) +
                                 phantom().parameters().l2_m * std::sin(q[2]) <
                             0.0;
    const IkResult found =
        inverse_kinematics(phantom(), p, behind_axis ? IkBranch::flip_up : IkBranch::up);
    if (std::hypot(p.x(), p.z() + phantom().parameters().l1_m) < 1e-3) continue;
    ASSERT_LT((found.q - q).norm(), 1e-11) << q.transpose();
    ASSERT_EQ(found.reach, Reach::ok) << text_of(found.reach);
  }
}

TEST(InverseKinematics, IsTheExactInverseOnTheBranchOfThePaper) {
  Random random{15};
  int tried = 0;
  while (tried < cases()) {
    const JointVector q = testing::random_posture(random);
    const ArmParameters& arm = phantom().parameters();
    const double rho = arm.l1_m * std::cos(q[1]) + arm.l2_m * std::sin(q[2]);
    if (rho < 0.01 || std::abs(q[2] - q[1]) > degrees(85.0)) continue;
    ++tried;
    const IkResult found = inverse_kinematics(phantom(), tool_position(phantom(), q));
    ASSERT_LT((found.q - q).norm(), 1e-12) << q.transpose();
    ASSERT_EQ(found.reach, check_limits(phantom(), q)) << text_of(found.reach);
  }
}

TEST(InverseKinematics, EveryBranchReachesThePositionWithinAPicometreAndKeepsItsRange) {
  Random random{16};
  const Vector3 shoulder{0.0, 0.170, -0.215};
  for (int i = 0; i < cases(); ++i) {
    const Vector3 direction = testing::random_vector(random, 1.0).normalized();
    // From folded to stretched, ends included.
    const double r = i % 50 == 0 ? 0.385 : i % 50 == 1 ? 0.045 : random.uniform(0.045, 0.385);
    const Vector3 p = shoulder + r * direction;
    for (const IkBranch branch : kBranches) {
      const IkResult found = inverse_kinematics(phantom(), p, branch);
      ASSERT_LT((tool_position(phantom(), found.q) - p).norm(), 1e-12) << p.transpose();
      ASSERT_NE(found.reach, Reach::too_far);
      ASSERT_NE(found.reach, Reach::too_near);
      ASSERT_LE(std::abs(found.q[0]), pi);
      ASSERT_LE(std::abs(found.q[1]), pi);
      ASSERT_LE(std::abs(found.q[2] - found.q[1]), pi + 1e-12);
    }
  }
}

TEST(InverseKinematics, StretchesOrFoldsTowardsAPositionOutOfReach) {
  const Vector3 shoulder{0.0, 0.170, -0.215};
  const Vector3 direction = Vector3{0.3, 0.1, 0.8}.normalized();

  const IkResult far = inverse_kinematics(phantom(), shoulder + 0.6 * direction);
  EXPECT_EQ(far.reach, Reach::too_far);
  EXPECT_LT((tool_position(phantom(), far.q) - shoulder - 0.385 * direction).norm(), 1e-14);

  const IkResult near = inverse_kinematics(phantom(), shoulder + 0.02 * direction);
  EXPECT_EQ(near.reach, Reach::too_near);
  EXPECT_LT((tool_position(phantom(), near.q) - shoulder - 0.045 * direction).norm(), 1e-14);
}

TEST(InverseKinematics, SaysWhichStopAPositionBreaks) {
  struct Row {
    Reach reach;
    JointVector q;
    IkBranch branch;
  };
  const std::array rows{
      Row{Reach::ok, degrees(20.0, 10.0, 15.0), IkBranch::up},
      Row{Reach::joint1_low, degrees(-95.0, 10.0, 15.0), IkBranch::up},
      Row{Reach::joint1_high, degrees(95.0, 10.0, 15.0), IkBranch::up},
      Row{Reach::joint2_low, degrees(0.0, -130.0, -150.0), IkBranch::flip_up},
      Row{Reach::joint2_high, degrees(0.0, 125.0, 150.0), IkBranch::flip_up},
      Row{Reach::joint3_low, degrees(0.0, -10.0, -35.0), IkBranch::up},
      Row{Reach::joint3_high, degrees(0.0, 110.0, 220.0), IkBranch::flip_down},
      Row{Reach::q2_minus_q3, degrees(0.0, 60.0, -10.0), IkBranch::up},
      Row{Reach::q3_minus_q2, degrees(0.0, 0.0, 60.0), IkBranch::up},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(text_of(row.reach));
    const Vector3 p = tool_position(phantom(), row.q);
    const IkResult found = inverse_kinematics(phantom(), p, row.branch);
    EXPECT_LT((found.q - row.q).norm(), 1e-12) << found.q.transpose();
    EXPECT_EQ(found.reach, row.reach) << text_of(found.reach);
    EXPECT_EQ(check_limits(phantom(), row.q), row.reach);
  }
}

TEST(InverseKinematics, KeepsThePreviousYawOnTheYawAxis) {
  for (const double x : {0.0, 1e-12}) {
    for (const IkBranch branch : kBranches) {
      const IkResult found = inverse_kinematics(phantom(), {x, 0.35, -0.215}, branch, 0.7);
      EXPECT_EQ(found.q[0], 0.7);
      EXPECT_TRUE(found.q.allFinite());
    }
  }
  const IkResult beside = inverse_kinematics(phantom(), {1e-6, 0.35, -0.215}, IkBranch::up, 0.7);
  EXPECT_NEAR(beside.q[0], pi / 2.0, 1e-9);
}

TEST(InverseKinematics, AnswersWhatIsNotFiniteWithAValueAndNeverWithNaN) {
  for (const double wrong : {kNotANumber, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3 p = Vector3::Zero();
      p[axis] = wrong;
      const IkResult found = inverse_kinematics(phantom(), p);
      EXPECT_EQ(found.reach, Reach::not_finite);
      EXPECT_EQ(found.q, JointVector::Zero());
      EXPECT_EQ(check_limits(phantom(), p), Reach::not_finite);
    }
    EXPECT_EQ(inverse_kinematics(phantom(), Vector3::Zero(), IkBranch::up, wrong).reach,
              Reach::not_finite);
  }
  for (const double size : {1e-300, 1e6, 1e200, 1.7e308}) {
    for (const IkBranch branch : kBranches) {
      const IkResult found = inverse_kinematics(phantom(), {size, -size, size}, branch);
      EXPECT_TRUE(found.q.allFinite()) << size;
    }
  }
}

TEST(InverseKinematics, OfEqualLinksFindsAnArmFoldedOntoItsShoulder) {
  ArmParameters parameters = phantom().parameters();
  parameters.l2_m = parameters.l1_m;
  const ArmModel arm{parameters};
  const Vector3 shoulder{0.0, parameters.l2_m, -parameters.l1_m};
  for (const IkBranch branch : kBranches) {
    const IkResult found = inverse_kinematics(arm, shoulder, branch);
    EXPECT_TRUE(found.q.allFinite());
    EXPECT_LT((tool_position(arm, found.q) - shoulder).norm(), 1e-15);
  }
}

TEST(CheckLimits, LetsAPostureStandAtItsStop) {
  const ArmParameters& arm = phantom().parameters();
  EXPECT_EQ(check_limits(phantom(), {arm.lower_limit_rad[0], 0.0, 0.0}), Reach::ok);
  EXPECT_EQ(check_limits(phantom(), {arm.upper_limit_rad[0], 0.0, 0.0}), Reach::ok);
  EXPECT_EQ(check_limits(phantom(), {0.0, arm.max_q2_minus_q3_rad, 0.0}), Reach::ok);
  EXPECT_EQ(check_limits(phantom(), {0.0, 0.0, arm.max_q3_minus_q2_rad}), Reach::ok);
}

TEST(Reach, EveryValueHasItsOwnText) {
  for (std::uint8_t i = 0; i <= 11; ++i) {
    for (std::uint8_t j = 0; j < i; ++j) {
      EXPECT_NE(text_of(static_cast<Reach>(i)), text_of(static_cast<Reach>(j)));
    }
  }
}

TEST(Kinematics, RunsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const ArmModel& arm = phantom();
  const JointVector q{0.1, 0.2, 0.3};
  double sum = 0.0;

  const testing::NoAllocation guard;
  sum += forward_kinematics(arm, q).p.sum() + tool_position(arm, q).sum();
  sum += body_jacobian(arm, q).sum() + hybrid_jacobian(arm, q).sum();
  sum += linear_jacobian(arm, q).sum() + linear_jacobian_rate(arm, q, q).sum();
  sum += manipulability(arm, q) + inverse_kinematics(arm, q / 10.0).q.sum();

  EXPECT_EQ(guard.count(), 0U) << sum;
}

}  // namespace
}  // namespace teleop
