#include "core/estimation/kalman_velocity.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;
const JointVector kCounts{40'000.0, 50'000.0, 60'000.0};

/// ω of the filter that a joint settles at.
double bandwidth(double counts, double jerk) {
  const double quantum = 2.0 * std::numbers::pi / counts;
  return std::pow(12.0 * jerk * jerk / (quantum * quantum * kPeriod), 1.0 / 6.0);
}

TEST(KalmanVelocity, MeetsASteadySpeedUnderJitter) {
  KalmanVelocity estimator{{}, kCounts};
  const JointVector speed{0.3, -2.0, 7.0};
  Random random{21};
  double t = 0.0;
  JointVector estimate;
  for (int k = 0; k < 1000; ++k) {
    estimate = estimator.step({.q = speed * t, .dt = kPeriod});
    t += kPeriod;
    if (k > 0 && k % 3 == 0) {
      const double dt = kPeriod * random.uniform(0.01, 5.0);
      t += dt - kPeriod;
      estimate = estimator.step({.q = speed * t, .dt = dt});
      t += kPeriod;
    }
  }
  EXPECT_NEAR((estimate - speed).norm(), 0.0, 1e-9);
}

TEST(KalmanVelocity, DoesNotLagASteadyAcceleration) {
  KalmanVelocity estimator{{}, kCounts};
  double t = 0.0;
  JointVector estimate;
  for (int k = 0; k <= 1000; ++k) {
    t = k * kPeriod;
    estimate = estimator.step({.q = JointVector::Constant(0.5 * t * t), .dt = kPeriod});
  }
  EXPECT_NEAR((estimate - JointVector::Constant(t)).norm(), 0.0, 1e-8);
}

/// The filter by its definition: the covariance of ẋ = (x₂, x₃, w) integrated in small steps.
class IntegratedFilter {
 public:
  IntegratedFilter(double density, double rounding) : density_{density}, rounding_{rounding} {
    P_ = Eigen::Vector3d{rounding, 100.0, 1e6}.asDiagonal();
  }
  double step(double q, double dt) {
    constexpr int kSubsteps = 400;
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    A(0, 1) = A(1, 2) = 1.0;
    Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
    W(2, 2) = density_;
    const double h = dt / kSubsteps;
    for (int i = 0; i < kSubsteps; ++i) {  // Heun
      const Eigen::Matrix3d slope = A * P_ + P_ * A.transpose() + W;
      const Eigen::Matrix3d ahead = P_ + h * slope;
      P_ += h / 2.0 * (slope + A * ahead + ahead * A.transpose() + W);
      const Eigen::Vector3d x_slope = A * x_;
      x_ += h / 2.0 * (x_slope + A * (x_ + h * x_slope));
    }
    const Eigen::Vector3d gain = P_.col(0) / (P_(0, 0) + rounding_);
    x_ += gain * (q - x_[0]);
    P_ -= gain * P_.row(0);
    P_ = (0.5 * (P_ + P_.transpose())).eval();
    return x_[1];
  }

 private:
  double density_;
  double rounding_;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_;
};

TEST(KalmanVelocity, IsTheFilterOfItsModelAtUnevenTimes) {
  // A jerk so large that the noise of one step matters.
  constexpr double kJerk = 3000.0;
  const double quantum = 2.0 * std::numbers::pi / kCounts[0];
  KalmanVelocity estimator{{.jerk_rad_per_s3_per_rtHz = kJerk}, kCounts};
  IntegratedFilter integrated{kJerk * kJerk, quantum * quantum / 12.0};
  Random random{23};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  double q = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double dt = kPeriod * random.uniform(0.3, 4.0);
    q += 1e-3 * random.normal();
    const double expected = integrated.step(q, dt);
    const double estimate = estimator.step({.q = JointVector::Constant(q), .dt = dt})[0];
    ASSERT_NEAR(estimate, expected, 2e-3) << k;
  }
}

TEST(KalmanVelocity, SettlesAtTheStatedButterworthFilter) {
  // Slow against the sampling, or the discrete filter is another one.
  constexpr double kJerk = 0.02;
  KalmanVelocity estimator{{.jerk_rad_per_s3_per_rtHz = kJerk}, kCounts};
  for (int k = 0; k < 3000; ++k) {
    estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double w = bandwidth(kCounts[i], kJerk);
    KalmanVelocity settled = estimator;
    double in_phase = 0.0;
    double quadrature = 0.0;
    const int cycle = static_cast<int>(std::round(2.0 * std::numbers::pi / w / kPeriod));
    const double at = 2.0 * std::numbers::pi / (cycle * kPeriod);  // near ω, whole cycles
    for (int k = 0; k < 40 * cycle; ++k) {
      const double phase = at * k * kPeriod;
      const JointVector q = JointVector::Constant(std::sin(phase) / at);
      const double estimate = settled.step({.q = q, .dt = kPeriod})[i];
      if (k < 20 * cycle) continue;
      in_phase += estimate * std::cos(phase) / (10.0 * cycle);
      quadrature -= estimate * std::sin(phase) / (10.0 * cycle);
    }
    const std::complex<double> s{0.0, at / w};
    const std::complex<double> stated = (2.0 * s + 1.0) / (s * s * s + 2.0 * s * s + 2.0 * s + 1.0);
    EXPECT_NEAR(in_phase, stated.real(), 0.015) << i;
    EXPECT_NEAR(quadrature, stated.imag(), 0.015) << i;
  }
}

TEST(KalmanVelocity, PassesRoundingWithTheStatedVariance) {
  constexpr double kJerk = 5.0;
  constexpr int kSamples = 300'000;
  KalmanVelocity estimator{{.jerk_rad_per_s3_per_rtHz = kJerk}, kCounts};
  Random random{22};
  JointVector power = JointVector::Zero();
  for (int k = 0; k < kSamples; ++k) {
    JointVector noise;
    for (Eigen::Index i = 0; i < 3; ++i) {
      noise[i] = 2.0 * std::numbers::pi / kCounts[i] * random.uniform(-0.5, 0.5);
    }
    const JointVector estimate = estimator.step({.q = noise, .dt = kPeriod});
    if (k >= 1000) power += estimate.cwiseAbs2() / (kSamples - 1000);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double quantum = 2.0 * std::numbers::pi / kCounts[i];
    const double stated =
        1.5 * std::pow(bandwidth(kCounts[i], kJerk), 3) * kPeriod * quantum * quantum / 12.0;
    EXPECT_NEAR(power[i] / stated, 1.0, 0.08) << i;
  }
}

TEST(KalmanVelocity, SurvivesGapsOfSecondsBetweenMinutesOfSamples) {
  KalmanVelocity estimator{{}, kCounts};
  estimator.step({.q = JointVector::Zero(), .dt = kPeriod});
  for (int k = 0; k < 200'000; ++k) {
    estimator.step({.q = JointVector::Zero(), .dt = k % 50'000 == 49'999 ? 10.0 : kPeriod});
  }
  JointVector estimate;
  for (int k = 1; k <= 500; ++k) {
    estimate = estimator.step({.q = JointVector::Constant(0.4 * k * kPeriod), .dt = kPeriod});
  }
  EXPECT_NEAR((estimate - JointVector::Constant(0.4)).norm(), 0.0, 1e-6);
}

TEST(KalmanVelocity, RejectsAMotionWithoutJerkAndArmsWithoutCounts) {
  EXPECT_THROW((KalmanVelocity{{.jerk_rad_per_s3_per_rtHz = 0.0}, kCounts}), ConfigError);
  EXPECT_THROW((KalmanVelocity{{.jerk_rad_per_s3_per_rtHz = -1.0}, kCounts}), ConfigError);
  EXPECT_THROW((KalmanVelocity{{}, JointVector::Zero()}), ConfigError);
}

}  // namespace
}  // namespace teleop
