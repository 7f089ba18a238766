#include "core/simulation/rigid_body.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "tests/simulation/plants.hpp"

namespace teleop {
namespace {

using testing::phantom;

struct Case {
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();
  JointVector u = JointVector::Zero();
};

template <class Check>
void for_many_states(Check check) {
  Random random{1};
  // NOLINTNEXTLINE(concurrency-mt-unsafe): single-threaded test
  const char* const cases = std::getenv("TELEOP_CASES");
  const int number = cases == nullptr ? 2000 : std::atoi(cases);
  const auto vector = [&](double bound) -> JointVector {
    return {random.uniform(-bound, bound), random.uniform(-bound, bound),
            random.uniform(-bound, bound)};
  };
  for (int i = 0; i < number; ++i) {
    check(Case{vector(1.5), vector(5.0), vector(50.0)});
  }
}

TEST(RigidBody, IsTheModelOfTheArm) {
  const RigidBody body{phantom()};
  for_many_states([&](const Case& at) {
    const RigidBody::Angles angles{at.q};
    const RigidBody::Inertia inertia = body.inertia(angles, at.qd);
    const Dynamics expected = dynamics(phantom(), at.q, at.qd);
    EXPECT_NEAR(inertia.M11, expected.M(0, 0), 1e-16);
    EXPECT_NEAR(inertia.M22, expected.M(1, 1), 1e-16);
    EXPECT_NEAR(inertia.M33, expected.M(2, 2), 1e-16);
    EXPECT_NEAR(inertia.M23, expected.M(1, 2), 1e-16);
    EXPECT_NEAR((inertia.bias - expected.C * at.qd - expected.N).norm(), 0.0, 1e-15);
    EXPECT_NEAR(body.energy(angles, at.qd),
                kinetic_energy(phantom(), at.q, at.qd) + potential_energy(phantom(), at.q), 1e-15);
  });
}

TEST(RigidBody, MovesTheToolAsTheJacobianSays) {
  const RigidBody body{phantom()};
  for_many_states([&](const Case& at) {
    const RigidBody::Angles angles{at.q};
    const Matrix3 J = linear_jacobian(phantom(), at.q);
    const Matrix3 rate = linear_jacobian_rate(phantom(), at.q, at.qd);
    const RigidBody::Tool tool = body.tool(angles, at.qd);
    EXPECT_NEAR((tool.p - tool_position(phantom(), at.q)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((tool.v - J * at.qd).norm(), 0.0, 1e-14);
    EXPECT_NEAR((body.torque(angles, at.u) - J.transpose() * at.u).norm(), 0.0, 1e-13);
    EXPECT_NEAR((body.tool_acceleration(angles, at.qd, at.u) - J * at.u - rate * at.qd).norm(), 0.0,
                1e-13);
  });
}

TEST(RigidBody, CarriesAMassAtTheToolWithAllItsCentrifugalTerms) {
  constexpr double kMass = 0.05;
  const RigidBody bare{phantom()};
  const RigidBody loaded{phantom(), kMass};
  for_many_states([&](const Case& at) {
    const RigidBody::Angles angles{at.q};
    const RigidBody::Inertia less = bare.inertia(angles, at.qd);
    const RigidBody::Inertia more = loaded.inertia(angles, at.qd);
    const Matrix3 J = linear_jacobian(phantom(), at.q);
    const Matrix3 added = kMass * J.transpose() * J;
    EXPECT_NEAR(more.M11 - less.M11, added(0, 0), 1e-16);
    EXPECT_NEAR(more.M22 - less.M22, added(1, 1), 1e-16);
    EXPECT_NEAR(more.M33 - less.M33, added(2, 2), 1e-16);
    EXPECT_NEAR(more.M23 - less.M23, added(1, 2), 1e-16);
    const JointVector rate =
        kMass * J.transpose() * linear_jacobian_rate(phantom(), at.q, at.qd) * at.qd;
    EXPECT_NEAR((more.bias - less.bias - rate).norm(), 0.0, 1e-14);
  });
}

TEST(RigidBody, TurnsItsAnglesToTheLastDigitButOne) {
  Random random{2};
  for_many_states([&](const Case& at) {
    const double size = random.uniform() < 0.8 ? 0.049 : 1.0;  // series and beyond
    const JointVector by = size / 5.0 * at.qd;
    const RigidBody::Angles turned = RigidBody::Angles{at.q}.turned(by);
    const RigidBody::Angles expected{at.q + by};
    EXPECT_NEAR(turned.c1, expected.c1, 4e-16);
    EXPECT_NEAR(turned.s1, expected.s1, 4e-16);
    EXPECT_NEAR(turned.c2, expected.c2, 4e-16);
    EXPECT_NEAR(turned.s2, expected.s2, 4e-16);
    EXPECT_NEAR(turned.c3, expected.c3, 4e-16);
    EXPECT_NEAR(turned.s3, expected.s3, 4e-16);
  });
}

}  // namespace
}  // namespace teleop
