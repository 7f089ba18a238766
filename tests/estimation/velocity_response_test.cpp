#include "core/estimation/velocity_response.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

EvenVelocity named(const char* kind) {
  return {.config = {.kind = kind}, .counts_per_rev = 47513.6};
}

TEST(VelocityResponse, OfTheMeanIsTheDifferenceOverItsSpan) {
  const auto h = impulse_response(named("mean"));
  ASSERT_EQ(h.size(), 101U);
  EXPECT_NEAR(h.front(), 10.0, 1e-9);
  EXPECT_NEAR(h.back(), -10.0, 1e-9);
  const double omega = 40.0;
  const auto stated = (1.0 - std::polar(1.0, -omega * 0.1)) / 0.1;
  EXPECT_NEAR(std::abs(response(h, kPeriod, omega) - stated), 0.0, 1e-9);
  EXPECT_NEAR(lag_s(h, kPeriod), 0.050, 1e-12);
  EXPECT_NEAR(noise_gain(h), std::sqrt(2.0) / 0.1, 1e-9);
}

TEST(VelocityResponse, OfTheDifferenceHasTheStatedLagAndNoise) {
  const auto h = impulse_response(named("difference"));
  const double a = 1.0 - std::exp(-kTwoPi * 300.0 * kPeriod);
  EXPECT_NEAR(lag_s(h, kPeriod), kPeriod / 2.0 + kPeriod * (1.0 - a) / a, 1e-12);
  EXPECT_NEAR(noise_gain(h), std::sqrt(2.0 * a * a / (2.0 - a)) / kPeriod, 1e-9);
}

TEST(VelocityResponse, OfTheKalmanFilterHasNoLagAndDifferentiatesSlowMotion) {
  const auto h = impulse_response(named("kalman"));
  EXPECT_NEAR(lag_s(h, kPeriod), 0.0, 1e-7);
  const std::complex<double> slow = response(h, kPeriod, 3.0);
  EXPECT_NEAR(std::abs(slow - std::complex<double>{0.0, 3.0}), 0.0, 1e-3);
}

TEST(VelocityResponse, TheDescribingFunctionOfALinearEstimatorIsItsResponse) {
  for (const char* kind : {"difference", "mean", "kalman"}) {
    const auto h = impulse_response(named(kind));
    for (const double f_Hz : {7.3, 31.0, 113.0}) {
      const double omega = kTwoPi * f_Hz;
      // Far above a count, rounding is nothing.
      const auto described = describing_function(named(kind), 0.2, omega);
      EXPECT_NEAR(std::abs(described - response(h, kPeriod, omega)) / omega, 0.0, 2e-3)
          << kind << ' ' << f_Hz;
    }
  }
}

TEST(VelocityResponse, ThePeriodCounterIsTheMeanOfSpeeds) {
  // Far above a count: no position difference, N speeds, so (N − 1)/2 samples late.
  const double omega = kTwoPi * 10.0;
  const auto described = describing_function(named("period"), 0.2, omega);
  std::complex<double> mean = 0.0;
  for (int k = 0; k < 16; ++k) {
    mean += std::polar(1.0 / 16.0, -omega * k * kPeriod);
  }
  EXPECT_NEAR(std::abs(described / std::complex<double>{0.0, omega} - mean), 0.0, 5e-3);
}

TEST(VelocityResponse, NonlinearEstimatorsAreNotCalledLinear) {
  for (const char* kind : {"period", "adaptive_window", "robust_exact"}) {
    EXPECT_FALSE(is_linear({.kind = kind}));
  }
}

}  // namespace
}  // namespace teleop
