#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/control/computed_torque.hpp"
#include "core/control/gravity.hpp"
#include "core/control/tool_damping.hpp"
#include "tests/model/postures.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::phantom;
using testing::random_allowed_posture;
using testing::random_vector;

TEST(GravityCompensation, LeavesTheArmAtRestWhereverItIsLetGo) {
  const GravityCompensation gravity{{}, phantom()};
  Random random{11};
  for (int i = 0; i < testing::cases(); ++i) {
    const JointVector q = random_allowed_posture(random);
    const JointVector qdd = forward_dynamics(phantom(), q, JointVector::Zero(), gravity.step(q));
    ASSERT_LT(qdd.norm(), 1e-10);
  }
}

TEST(GravityCompensation, CarriesTheShareAskedFor) {
  const GravityCompensation half{{.share = 0.5}, phantom()};
  const JointVector q{0.1, 0.2, 0.3};
  EXPECT_NEAR((half.step(q) - 0.5 * gravity_torque(phantom(), q)).norm(), 0.0, 1e-15);
}

TEST(GravityCompensation, RefusesAShareBeyondOne) {
  GravityCompensation::Config config;
  Settings settings;
  add_settings(settings, "gravity.", config);
  EXPECT_THROW(settings.set("gravity.share", "1.5", "command line"), ConfigError);
}

TEST(ToolDamping, OnlyTakesEnergy) {
  const ToolDamping damping{{.damping_Ns_per_m = 2.0}};
  Random random{12};
  for (int i = 0; i < testing::cases(); ++i) {
    const Vector3 v = random_vector(random, 1.0);
    ASSERT_NEAR(damping.step(v).dot(v), -2.0 * v.squaredNorm(), 1e-12);
  }
}

TEST(ToolDamping, IsOffUnlessAskedFor) {
  EXPECT_EQ(ToolDamping{{}}.step({1.0, 1.0, 1.0}).norm(), 0.0);
}

/// A smooth motion of all joints and its derivatives.
ComputedTorque::JointMotion desired_at(double t) {
  const JointVector w{3.0, 4.0, 5.0};
  ComputedTorque::JointMotion d;
  for (Eigen::Index i = 0; i < 3; ++i) {
    d.q[i] = 0.3 * std::sin(w[i] * t);
    d.qd[i] = 0.3 * w[i] * std::cos(w[i] * t);
    d.qdd[i] = -0.3 * w[i] * w[i] * std::sin(w[i] * t);
  }
  return d;
}

TEST(ComputedTorque, GivesTheAccelerationOfTheLinearErrorDynamics) {
  const ComputedTorque::Config config{.stiffness_per_s2 = {100.0, 400.0, 900.0},
                                      .damping_per_s = {5.0, 40.0, 90.0}};
  const ComputedTorque control{config, phantom()};
  Random random{13};
  for (int i = 0; i < testing::cases(); ++i) {
    const JointVector q = random_allowed_posture(random);
    const JointVector qd = random_vector(random, 5.0);
    const auto desired = desired_at(random.uniform(0.0, 10.0));
    const JointVector qdd = forward_dynamics(phantom(), q, qd, control.step(q, qd, desired));
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto joint = static_cast<std::size_t>(j);
      const double edd = -config.damping_per_s.at(joint) * (desired.qd[j] - qd[j]) -
                         config.stiffness_per_s2.at(joint) * (desired.q[j] - q[j]);
      ASSERT_NEAR(desired.qdd[j] - qdd[j], edd, 1e-8 * (1.0 + std::abs(edd)));
    }
  }
}

struct Motion {
  JointVector q;
  JointVector qd;
};

/// Classical Runge–Kutta step of the controlled arm.
Motion advanced(const ComputedTorque& control, const Motion& x, double t, double h) {
  const auto slope = [&](const Motion& at, double time) {
    const JointVector tau = control.step(at.q, at.qd, desired_at(time));
    return Motion{at.qd, forward_dynamics(phantom(), at.q, at.qd, tau)};
  };
  const auto moved = [&](const Motion& k, double by) {
    return Motion{x.q + by * k.q, x.qd + by * k.qd};
  };
  const Motion a = slope(x, t);
  const Motion b = slope(moved(a, h / 2.0), t + h / 2.0);
  const Motion c = slope(moved(b, h / 2.0), t + h / 2.0);
  const Motion d = slope(moved(c, h), t + h);
  return {x.q + h / 6.0 * (a.q + 2.0 * b.q + 2.0 * c.q + d.q),
          x.qd + h / 6.0 * (a.qd + 2.0 * b.qd + 2.0 * c.qd + d.qd)};
}

TEST(ComputedTorque, ErrorDecaysAsTheCriticallyDampedSolutionOnTheRigidModel) {
  const ComputedTorque control{{}, phantom()};
  const JointVector e0{0.05, -0.04, 0.03};
  Motion x{desired_at(0.0).q - e0, desired_at(0.0).qd};
  constexpr double kStep = 1e-4;
  for (int k = 0; k < 2000; ++k) {
    const double t = k * kStep;
    const double decay = (1.0 + 40.0 * t) * std::exp(-40.0 * t);  // e(0) = e0, ė(0) = 0
    ASSERT_LT(((desired_at(t).q - x.q) - decay * e0).norm(), 1e-9) << "t = " << t;
    x = advanced(control, x, t, kStep);
  }
}

TEST(LocalLaws, StepWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const GravityCompensation gravity{{}, phantom()};
  const ToolDamping damping{{}};
  const ComputedTorque control{{}, phantom()};
  const JointVector q{0.1, 0.2, 0.3};
  const testing::NoAllocation guard;
  [[maybe_unused]] const JointVector a = gravity.step(q);
  [[maybe_unused]] const Vector3 b = damping.step({1.0, 2.0, 3.0});
  [[maybe_unused]] const JointVector c = control.step(q, q, {});
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
