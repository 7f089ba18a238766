#include "core/estimation/smoother.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"

namespace teleop {
namespace {

struct Record {
  std::vector<double> t{};
  std::vector<JointVector> q{};
};

template <class Motion>
Record record(Motion&& motion, double jitter) {
  Random random{71};
  Record r;
  double t = 0.0;
  for (int k = 0; k < 2000; ++k) {
    t += 1e-3 * random.uniform(1.0 - jitter, 1.0 + jitter);
    r.t.push_back(t);
    r.q.push_back(motion(t));
  }
  return r;
}

TEST(ZeroPhaseVelocity, OfACubicIsItsSlopeAtUnevenTimesToo) {
  const Record r =
      record([](double t) { return JointVector{t * t * t - t, 2.0 * t * t, 3.0 * t}; }, 0.9);
  const auto v = zero_phase_velocity(r.t, r.q, 25.0);
  for (std::size_t k = 0; k < v.size(); ++k) {
    const double t = r.t[k];
    const JointVector slope{3.0 * t * t - 1.0, 4.0 * t, 3.0};
    ASSERT_NEAR((v[k] - slope).norm(), 0.0, 1e-6) << k;
  }
}

TEST(ZeroPhaseVelocity, HasNoPhaseAndTheStatedGain) {
  constexpr double kBandwidth_Hz = 25.0;
  for (const double f_Hz : {5.0, 15.0, 25.0, 40.0}) {
    const double w = 2.0 * std::numbers::pi * f_Hz;
    const Record r =
        record([&](double t) { return JointVector::Constant(std::sin(w * t) / w); }, 0.0);
    const auto v = zero_phase_velocity(r.t, r.q, kBandwidth_Hz);
    double in_phase = 0.0;
    double quadrature = 0.0;
    for (std::size_t k = 200; k < 1800; ++k) {  // whole cycles of each
      in_phase += v[k][0] * std::cos(w * r.t[k]) / 800.0;
      quadrature += v[k][0] * std::sin(w * r.t[k]) / 800.0;
    }
    const double s = 0.5 * std::pow(1.4676 * f_Hz / kBandwidth_Hz, 2);
    EXPECT_NEAR(in_phase, (1.0 + s) * std::exp(-s), 0.02) << f_Hz;
    EXPECT_NEAR(quadrature, 0.0, 1e-3) << f_Hz;
  }
}

TEST(ZeroPhaseMean, HasNoPhaseAndIsDownToTheRootOfAHalfAtItsBandwidth) {
  const double w = 2.0 * std::numbers::pi * 25.0;
  const Record r = record([&](double t) { return JointVector::Constant(std::sin(w * t)); }, 0.0);
  const auto mean = zero_phase_mean(r.t, r.q, 25.0);
  double in_phase = 0.0;
  double quadrature = 0.0;
  for (std::size_t k = 200; k < 1800; ++k) {
    in_phase += mean[k][0] * std::sin(w * r.t[k]) / 800.0;
    quadrature += mean[k][0] * std::cos(w * r.t[k]) / 800.0;
  }
  EXPECT_NEAR(in_phase, std::numbers::sqrt2 / 2.0, 0.01);
  EXPECT_NEAR(quadrature, 0.0, 1e-3);
}

}  // namespace
}  // namespace teleop
