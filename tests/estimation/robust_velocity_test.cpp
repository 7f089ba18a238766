#include "core/estimation/robust_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

/// Largest error over the second half of two seconds of A sin ωt.
double worst_error(double bound, double amplitude, double omega, double noise) {
  RobustVelocity estimator{{.acceleration_rad_per_s2 = bound}};
  Random random{41};
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double t = k * kPeriod;
    const double q = amplitude * std::sin(omega * t) + noise * random.uniform(-1.0, 1.0);
    const double estimate = estimator.step({.q = JointVector::Constant(q), .dt = kPeriod})[0];
    const double error = estimate - amplitude * omega * std::cos(omega * t);
    if (k >= 1000) worst = std::max(worst, std::abs(error));
  }
  return worst;
}

TEST(RobustVelocity, FollowsAMotionWithinItsAccelerationButForHalfASample) {
  // |q̈| = 20 of 50 rad/s²; half a sample late is 0.01 rad/s.
  EXPECT_LT(worst_error(50.0, 0.2, 10.0, 0.0), 1.05 * 20.0 * kPeriod / 2.0);
}

TEST(RobustVelocity, ErrsByTheRootOfNoiseTimesAcceleration) {
  for (const double noise : {1e-5, 1e-4, 1e-3}) {
    const double error = worst_error(50.0, 0.1, 10.0, noise);
    const double order = std::sqrt(50.0 * noise);
    EXPECT_LT(error, 3.0 * order) << noise;
    EXPECT_GT(error, 0.1 * order) << noise;
  }
}

TEST(RobustVelocity, MeetsASteadySpeedExactlyUnderJitter) {
  RobustVelocity estimator{{}};
  const JointVector speed{0.3, -2.0, 7.0};
  Random random{42};
  double t = 0.0;
  JointVector estimate;
  for (int k = 0; k < 3000; ++k) {
    const double dt = kPeriod * random.uniform(0.01, 5.0);
    t += dt;
    estimate = estimator.step({.q = speed * t, .dt = dt});
  }
  EXPECT_NEAR((estimate - speed).norm(), 0.0, 1e-9);
}

TEST(RobustVelocity, DoesNotChatterAtRestAtAnyAcceleration) {
  for (const double bound : {1.0, 50.0, 1e4, 1e8}) {
    RobustVelocity estimator{{.acceleration_rad_per_s2 = bound}};
    estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
    JointVector estimate;
    for (int k = 0; k < 3000; ++k) {
      estimate = estimator.step({.q = JointVector::Constant(1e-3), .dt = kPeriod});
    }
    EXPECT_NEAR(estimate.norm(), 0.0, 1e-12) << bound;
  }
}

TEST(RobustVelocity, NeverChangesFasterThanItsAcceleration) {
  RobustVelocity estimator{{.acceleration_rad_per_s2 = 50.0}};
  Random random{43};
  JointVector last = JointVector::Zero();
  for (int k = 0; k < 5000; ++k) {
    const double dt = kPeriod * random.uniform(0.1, 4.0);
    const JointVector q{random.normal(), 1e-4 * random.normal(), random.uniform()};
    const JointVector estimate = estimator.step({.q = q, .dt = dt});
    EXPECT_LE((estimate - last).cwiseAbs().maxCoeff(), 1.1 * 50.0 * dt * (1.0 + 1e-9) + 1e-12);
    last = estimate;
  }
}

TEST(RobustVelocity, WithALargeAccelerationIsTheFirstDifference) {
  RobustVelocity estimator{{.acceleration_rad_per_s2 = 1e6}};
  Random random{44};
  double last = 0.0;
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  for (int k = 0; k < 100; ++k) {
    const double q = 0.1 * random.uniform();
    const double estimate = estimator.step({.q = JointVector::Constant(q), .dt = kPeriod})[2];
    EXPECT_NEAR(estimate, (q - last) / kPeriod, 1e-9);
    last = q;
  }
}

TEST(RobustVelocity, RejectsAnAccelerationThatIsNotPositive) {
  EXPECT_THROW((RobustVelocity{{.acceleration_rad_per_s2 = 0.0}}), ConfigError);
  EXPECT_THROW(
      (RobustVelocity{{.acceleration_rad_per_s2 = std::numeric_limits<double>::infinity()}}),
      ConfigError);
}

}  // namespace
}  // namespace teleop
