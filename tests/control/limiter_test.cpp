#include "core/control/limiter.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/model/postures.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::random_vector;

constexpr double kPeriod = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A vector of any direction whose length spans many decades.
Vector3 any_size(Random& random) {
  return random_vector(random, 1.0) * std::pow(10.0, random.uniform(-6.0, 6.0));
}

bool same_direction(const Vector3& a, const Vector3& b) {
  return (a.stableNormalized() - b.stableNormalized()).norm() < 1e-9;
}

TEST(Limiter, NeverPassesAForceBeyondTheLimitAndKeepsItsDirection) {
  const Limiter limiter{{.max_force_N = 5.0}};
  Random random{21};
  for (int i = 0; i < testing::cases(); ++i) {
    const Vector3 f = any_size(random);
    const auto limited = limiter.limit_force(f);
    ASSERT_LE(limited.f.norm(), 5.0 * (1.0 + 1e-12));
    ASSERT_TRUE(same_direction(limited.f, f));
    ASSERT_EQ(limited.limits.has(Limit::force), f.norm() > 5.0);
    if (f.norm() <= 5.0) {
      ASSERT_EQ(limited.f, f);
    }
  }
}

TEST(Limiter, NeverPassesATorqueBeyondTheLimitAndKeepsItsDirection) {
  const JointVector max{1.0, 2.0, 0.5};
  Limiter limiter{{.max_torque_Nm = {1.0, 2.0, 0.5}, .max_slew_Nm_per_s = 1e12}};
  Random random{22};
  for (int i = 0; i < testing::cases(); ++i) {
    const JointVector tau = any_size(random);
    const auto limited = limiter.step(tau, kPeriod);
    const bool beyond = (tau.cwiseAbs() - max).maxCoeff() > 0.0;
    ASSERT_LE((limited.tau.cwiseAbs() - max).maxCoeff(), 1e-12);
    ASSERT_TRUE(same_direction(limited.tau, tau));
    ASSERT_EQ(limited.limits.has(Limit::torque), beyond);
  }
}

TEST(Limiter, NeverChangesTheTorqueFasterThanAllowedAndKeepsTheDirectionOfTheChange) {
  const JointVector max{1.0, 2.0, 0.5};
  Limiter limiter{{.max_torque_Nm = {1.0, 2.0, 0.5}, .max_slew_Nm_per_s = 100.0}};
  Random random{23};
  for (int i = 0; i < testing::cases(); ++i) {
    const JointVector before = limiter.state().tau;
    const JointVector tau = random_vector(random, 0.49);
    const double dt = kPeriod * random.uniform(0.1, 5.0);
    const auto limited = limiter.step(tau, dt);
    const JointVector change = limited.tau - before;
    ASSERT_LE(change.norm(), 100.0 * dt * (1.0 + 1e-12));
    ASSERT_TRUE(same_direction(change, tau - before));
    ASSERT_EQ(limited.limits.has(Limit::slew), (tau - before).norm() > 100.0 * dt);
    ASSERT_LE((limited.tau.cwiseAbs() - max).maxCoeff(), 1e-12);
  }
}

TEST(Limiter, ReachesAConstantTorqueAndThenReportsNothing) {
  Limiter limiter{{.max_slew_Nm_per_s = 100.0}};
  const JointVector tau{0.5, -0.5, 0.25};
  for (int k = 0; k < 8; ++k)
    limiter.step(tau, kPeriod);
  const auto limited = limiter.step(tau, kPeriod);
  EXPECT_EQ(limited.tau, tau);
  EXPECT_EQ(limited.limits.bits(), 0U);
}

TEST(Limiter, LeavesZeroAtZero) {
  Limiter limiter{{}};
  EXPECT_EQ(limiter.limit_force(Vector3::Zero()).f, Vector3::Zero());
  const auto limited = limiter.step(JointVector::Zero(), kPeriod);
  EXPECT_EQ(limited.tau, JointVector::Zero());
  EXPECT_EQ(limited.limits.bits(), 0U);
  EXPECT_EQ(limited.fault, Fault::none);
}

TEST(Limiter, TurnsWhatIsNoNumberIntoZeroAtOnceAndReportsIt) {
  Limiter limiter{{}};
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      limiter.step({0.1, 0.1, 0.1}, 1.0);
      Vector3 v{0.1, 0.2, 0.3};
      v[axis] = bad;
      EXPECT_EQ(limiter.limit_force(v).f, Vector3::Zero());
      EXPECT_EQ(limiter.limit_force(v).fault, Fault::state_not_finite);
      EXPECT_EQ(limiter.step(v, kPeriod).tau, JointVector::Zero());
      EXPECT_EQ(limiter.state().tau, JointVector::Zero());
      EXPECT_EQ(limiter.step(v, kPeriod).fault, Fault::state_not_finite);
    }
  }
  EXPECT_EQ(limiter.step({0.1, 0.1, 0.1}, kNaN).fault, Fault::state_not_finite);
}

TEST(Limiter, SurvivesTheLargestNumbers) {
  Limiter limiter{{}};
  const double huge = std::numeric_limits<double>::max();
  EXPECT_TRUE(limiter.limit_force({huge, -huge, huge}).f.allFinite());
  EXPECT_TRUE(limiter.step({huge, -huge, huge}, kPeriod).tau.allFinite());
}

TEST(Limiter, StartsFromZeroAfterReset) {
  Limiter limiter{{.max_slew_Nm_per_s = 100.0}};
  limiter.step({1.0, 0.0, 0.0}, 1.0);
  limiter.reset();
  EXPECT_NEAR(limiter.step({1.0, 0.0, 0.0}, kPeriod).tau.norm(), 0.1, 1e-12);
}

TEST(Limiter, RejectsLimitsThatAreNotPositive) {
  EXPECT_THROW((Limiter{{.max_force_N = 0.0}}), ConfigError);
  EXPECT_THROW((Limiter{{.max_torque_Nm = {1.0, -1.0, 1.0}}}), ConfigError);
  EXPECT_THROW((Limiter{{.max_slew_Nm_per_s = kInfinity}}), ConfigError);
}

TEST(Limiter, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Limiter limiter{{}};
  const testing::NoAllocation guard;
  [[maybe_unused]] const auto force = limiter.limit_force({100.0, 0.0, 0.0});
  limiter.step({10.0, 1.0, 1.0}, kPeriod);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
