#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "tests/model/postures.hpp"

namespace teleop {
namespace {

using nlohmann::json;

/// Relative to the size of the whole vector or matrix; the floor is for those that are zero.
template <typename Actual, typename Expected>
::testing::AssertionResult agrees(const Actual& actual, const Expected& expected) {
  constexpr double kRelative = 1e-12;
  constexpr double kFloor = 1e-15;
  const double error = (actual - expected).norm();
  if (error <= kRelative * expected.norm() + kFloor) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "off by " << error << ": is\n"
                                       << actual << "\nshould be\n"
                                       << expected;
}

::testing::AssertionResult agrees(double actual, double expected) {
  return agrees(Eigen::Matrix<double, 1, 1>{actual}, Eigen::Matrix<double, 1, 1>{expected});
}

Vector3 vector(const json& list) { return Vector3{list.get<std::array<double, 3>>().data()}; }

template <int Rows>
Eigen::Matrix<double, Rows, 3> matrix(const json& rows) {
  Eigen::Matrix<double, Rows, 3> result;
  for (int i = 0; i < Rows; ++i) {
    result.row(i) = vector(rows.at(static_cast<std::size_t>(i)));
  }
  return result;
}

/// Poses of a 50-digit computation of the corrected equations.
class Reference : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string file = TELEOP_SOURCE_DIR "/../shared/paper/reference_vectors.json";
    std::ifstream stream{file};
    if (!stream) GTEST_SKIP() << "no reference vectors: " << file;
    poses_ = json::parse(stream).at("poses");
    ASSERT_GE(poses_.size(), 20U);
  }

  // NOLINTBEGIN(readability-identifier-naming): gtest wants protected what is private in spirit
  const ArmModel& arm_ = testing::phantom();
  json poses_;
  // NOLINTEND(readability-identifier-naming)
};

TEST_F(Reference, PoseAndJacobiansAgree) {
  for (const json& pose : poses_) {
    SCOPED_TRACE(pose.at("name"));
    const JointVector q = vector(pose.at("theta"));
    const Pose X_BT = forward_kinematics(arm_, q);
    EXPECT_TRUE(agrees(X_BT.p, vector(pose.at("p"))));
    EXPECT_TRUE(agrees(tool_position(arm_, q), vector(pose.at("p"))));
    EXPECT_TRUE(agrees(X_BT.R, matrix<3>(pose.at("R"))));
    EXPECT_TRUE(agrees(body_jacobian(arm_, q), matrix<6>(pose.at("J_body"))));
    EXPECT_TRUE(agrees(hybrid_jacobian(arm_, q), matrix<6>(pose.at("J_hybrid"))));
    const Matrix3 J_v = linear_jacobian(arm_, q);
    EXPECT_TRUE(agrees(J_v, matrix<6>(pose.at("J_hybrid")).topRows<3>()));
    EXPECT_TRUE(agrees(J_v.determinant(), pose.at("det_Jv").get<double>()));
  }
}

TEST_F(Reference, DynamicsAgree) {
  for (const json& pose : poses_) {
    SCOPED_TRACE(pose.at("name"));
    const JointVector q = vector(pose.at("theta"));
    const JointVector qd = vector(pose.at("theta_dot"));
    const auto [M, C, N] = dynamics(arm_, q, qd);
    EXPECT_TRUE(agrees(M, matrix<3>(pose.at("M"))));
    EXPECT_TRUE(agrees(mass_matrix(arm_, q), matrix<3>(pose.at("M"))));
    EXPECT_TRUE(agrees(C, matrix<3>(pose.at("C"))));
    EXPECT_TRUE(agrees(N, vector(pose.at("N"))));
    EXPECT_TRUE(agrees(gravity_torque(arm_, q), vector(pose.at("N"))));
    EXPECT_TRUE(agrees(C * qd, vector(pose.at("C_theta_dot"))));

    const JointVector tau = vector(pose.at("tau_in"));
    const JointVector qdd = vector(pose.at("theta_ddot"));
    EXPECT_TRUE(agrees(forward_dynamics(arm_, q, qd, tau), qdd));
    EXPECT_TRUE(agrees(inverse_dynamics(arm_, q, qd, qdd), tau));
  }
}

TEST_F(Reference, EnergiesToolMassAndTorqueOfAWrenchAgree) {
  for (const json& pose : poses_) {
    SCOPED_TRACE(pose.at("name"));
    const JointVector q = vector(pose.at("theta"));
    const JointVector qd = vector(pose.at("theta_dot"));
    EXPECT_TRUE(agrees(kinetic_energy(arm_, q, qd), pose.at("kinetic_energy").get<double>()));
    EXPECT_TRUE(agrees(potential_energy(arm_, q), pose.at("potential_energy").get<double>()));

    const auto mass = tool_mass(arm_, q);
    EXPECT_TRUE(
        agrees(mass.value_or(Matrix3::Zero()), matrix<3>(pose.at("Lambda_cartesian_mass"))));

    Eigen::Matrix<double, 6, 1> F;
    for (int i = 0; i < 6; ++i) {
      F[i] = pose.at("wrench_hybrid_in").at(static_cast<std::size_t>(i)).get<double>();
    }
    const JointVector tau = hybrid_jacobian(arm_, q).transpose() * F;
    EXPECT_TRUE(agrees(tau, vector(pose.at("tau_from_wrench"))));
  }
}

TEST_F(Reference, AllBranchesOfInverseKinematicsAgreeUpToWholeTurns) {
  for (const json& pose : poses_) {
    const Vector3 p = vector(pose.at("p"));
    for (const auto branch :
         {IkBranch::up, IkBranch::down, IkBranch::flip_up, IkBranch::flip_down}) {
      SCOPED_TRACE(pose.at("name").get<std::string>() + " branch " +
                   std::to_string(static_cast<int>(branch)));
      const auto index = static_cast<std::size_t>(branch);
      const JointVector expected = vector(pose.at("ik_branches").at(index));
      JointVector q = inverse_kinematics(arm_, p, branch).q;
      for (Eigen::Index i = 0; i < 3; ++i) {
        q[i] = expected[i] + std::remainder(q[i] - expected[i], 2.0 * std::numbers::pi);
      }
      EXPECT_TRUE(agrees(q, expected));
    }
  }
}

TEST_F(Reference, PrintedSignOfC32GivesTheTorqueThatTheErrataRefute) {
  for (const json& pose : poses_) {
    SCOPED_TRACE(pose.at("name"));
    const JointVector qd = vector(pose.at("theta_dot"));
    JointMatrix C = dynamics(arm_, vector(pose.at("theta")), qd).C;
    C(2, 1) = -C(2, 1);
    EXPECT_TRUE(agrees(C * qd, vector(pose.at("C_theta_dot_wrong_sign_C32"))));
  }
}

}  // namespace
}  // namespace teleop
