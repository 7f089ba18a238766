#include "core/estimation/window_velocity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;
const JointVector kCounts = JointVector::Constant(47513.6);
const double kQuantum = 2.0 * std::numbers::pi / kCounts[0];

double rounded(double q) { return kQuantum * std::round(q / kQuantum); }

/// The end fit as its definition reads: n grows while the line to sample n passes all between.
double defined_end_fit(const std::vector<double>& q,
                       const std::vector<double>& t,
                       std::size_t most) {
  const std::size_t k = q.size() - 1;
  double slope = 0.0;
  for (std::size_t n = 1; n <= std::min(most, k); ++n) {
    const double candidate = (q[k] - q[k - n]) / (t[k] - t[k - n]);
    for (std::size_t i = 1; i < n; ++i) {
      const double line = q[k] - candidate * (t[k] - t[k - i]);
      if (std::abs(q[k - i] - line) > kQuantum) return slope;
    }
    slope = candidate;
  }
  return slope;
}

TEST(WindowVelocity, IsTheEndFitAsDefined) {
  WindowVelocity estimator{{.samples = 20}, kCounts};
  Random random{31};
  std::vector<double> q;
  std::vector<double> t;
  double now = 0.0;
  double acceleration = 0.0;
  double speed = 0.0;
  double angle = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double dt = kPeriod * random.uniform(0.5, 1.5);
    if (k % 100 == 0) acceleration = 20.0 * random.normal();
    speed += dt * (acceleration - 2.0 * speed);
    angle += dt * speed;
    now += dt;
    q.push_back(rounded(angle));
    t.push_back(now);
    const double estimate = estimator.step({.q = JointVector::Constant(q.back()), .dt = dt})[1];
    ASSERT_NEAR(estimate, defined_end_fit(q, t, 20), 1e-7) << k;
  }
}

TEST(WindowVelocity, MeetsASteadySpeedWithinACountOverTheWindow) {
  for (const bool best : {false, true}) {
    for (const double speed : {0.0, 0.004, 0.05, -0.7, 3.0}) {
      WindowVelocity estimator{{.best_fit = best}, kCounts};
      for (int k = 0; k < 400; ++k) {
        const double q = rounded(speed * k * kPeriod);
        const double estimate = estimator.step({.q = JointVector::Constant(q), .dt = kPeriod})[0];
        if (k < 30) continue;
        EXPECT_EQ(estimator.window()[0], 30U) << "rounding alone never shortens the window";
        EXPECT_LE(std::abs(estimate - speed), kQuantum / (30 * kPeriod) + 1e-12) << speed;
      }
    }
  }
}

TEST(WindowVelocity, MeetsAnUnroundedSteadySpeedExactlyUnderJitter) {
  for (const bool best : {false, true}) {
    WindowVelocity estimator{{.best_fit = best}, kCounts};
    const JointVector speed{0.3, -2.0, 7.0};
    Random random{32};
    double t = 0.0;
    estimator.step({.q = speed * t, .dt = kPeriod});
    for (int k = 0; k < 300; ++k) {
      const double dt = kPeriod * random.uniform(0.01, 5.0);
      t += dt;
      const JointVector estimate = estimator.step({.q = speed * t, .dt = dt});
      EXPECT_NEAR((estimate - speed).norm(), 0.0, 1e-8);
    }
  }
}

TEST(WindowVelocity, ShortensToTheWindowThatAnAccelerationAllows) {
  // The chord of a parabola is a n²Δt²/8 off in its middle.
  constexpr double kAcceleration = 40.0;
  WindowVelocity estimator{{.samples = 60}, kCounts};
  double t = 0.0;
  JointVector estimate;
  for (int k = 0; k <= 500; ++k) {
    t = k * kPeriod;
    const double q = 0.5 * kAcceleration * t * t;
    estimate = estimator.step({.q = JointVector::Constant(q), .dt = kPeriod});
  }
  const double n = std::floor(std::sqrt(8.0 * kQuantum / kAcceleration) / kPeriod);
  EXPECT_NEAR(static_cast<double>(estimator.window()[0]), n, 1.0);
  const double lag = t - estimate[0] / kAcceleration;
  EXPECT_NEAR(lag, static_cast<double>(estimator.window()[0]) * kPeriod / 2.0, 1e-6);
}

TEST(WindowVelocity, ShortensTheBestFitLess) {
  // Least squares leave a n²Δt²/12 of a parabola at its ends.
  constexpr double kAcceleration = 40.0;
  WindowVelocity estimator{{.samples = 60, .best_fit = true}, kCounts};
  for (int k = 0; k <= 500; ++k) {
    const double t = k * kPeriod;
    const double q = 0.5 * kAcceleration * t * t;
    estimator.step({.q = JointVector::Constant(q), .dt = kPeriod});
  }
  const double n = std::floor(std::sqrt(12.0 * kQuantum / kAcceleration) / kPeriod);
  EXPECT_NEAR(static_cast<double>(estimator.window()[0]), n, 1.0);
}

TEST(WindowVelocity, BestFitIsCalmerThanTheEndFit) {
  const auto ripple = [](bool best) {
    WindowVelocity estimator{{.best_fit = best}, kCounts};
    Random random{33};
    double power = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      const double q = kQuantum * random.uniform(-0.5, 0.5);
      power += std::pow(estimator.step({.q = JointVector::Constant(q), .dt = kPeriod})[0], 2);
    }
    return power;
  };
  EXPECT_LT(ripple(true), 0.7 * ripple(false));
}

TEST(WindowVelocity, RejectsWindowsItCannotHold) {
  EXPECT_THROW((WindowVelocity{{.samples = 0}, kCounts}), ConfigError);
  EXPECT_THROW((WindowVelocity{{.samples = WindowVelocity::kMostSamples + 1}, kCounts}),
               ConfigError);
  EXPECT_THROW((WindowVelocity{{.noise_counts = 0.0}, kCounts}), ConfigError);
  EXPECT_THROW((WindowVelocity{{}, JointVector::Zero()}), ConfigError);
}

}  // namespace
}  // namespace teleop
