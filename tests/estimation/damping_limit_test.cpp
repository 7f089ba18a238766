#include "core/estimation/damping_limit.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/estimation/velocity_response.hpp"
#include "core/math/random.hpp"
#include "tests/estimation/encoder.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

EvenVelocity mean_of(int samples) {
  return {.config = {.kind = "mean", .mean = {.samples = samples}}, .counts_per_rev = 47513.6};
}

std::optional<DampingLimit> limit(const SampledMass& mass, const EvenVelocity& estimator) {
  const auto h = impulse_response(estimator);
  return damping_limit(mass, [&](double w) { return response(h, mass.period_s, w); }, {});
}

/// Largest |eigenvalue| of x and v and the last N places under f = −B (x[k] − x[k−N])/(N T).
double spectral_radius(const SampledMass& mass, int N, double B) {
  const double h = mass.damping_Ns_per_m * kPeriod / mass.mass_kg;
  const double g1 = -std::expm1(-h) / h;
  const double g2 = (1.0 - g1) / h;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(N + 2, N + 2);  // v, x[k], x[k−1] … x[k−N]
  A(0, 0) = std::exp(-h);
  A(1, 0) = kPeriod * g1;
  A(1, 1) = 1.0;
  for (int i = 2; i < N + 2; ++i) {
    A(i, i - 1) = 1.0;
  }
  const double force = -B / (N * kPeriod);
  const double push_v = kPeriod / mass.mass_kg * g1;
  const double push_x = kPeriod * kPeriod / mass.mass_kg * g2;
  A(0, 1) += push_v * force;
  A(0, N + 1) -= push_v * force;
  A(1, 1) += push_x * force;
  A(1, N + 1) -= push_x * force;
  // One eigenvalue is 1 at any B: the tool may stand anywhere.
  const Eigen::VectorXcd values = A.eigenvalues();
  double largest = 0.0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::abs(values[i] - 1.0) > 1e-6) largest = std::max(largest, std::abs(values[i]));
  }
  return largest;
}

TEST(DampingLimit, IsWhereTheFirstEigenvalueReachesTheUnitCircle) {
  Random random{61};
  for (int n = 0; n < 12; ++n) {
    const SampledMass mass{.mass_kg = random.uniform(0.02, 0.12),
                           .damping_Ns_per_m = random.uniform(0.2, 5.0)};
    const int N = 1 + static_cast<int>(random.uniform(0.0, 24.0));
    const auto found = limit(mass, mean_of(N));
    ASSERT_TRUE(found.has_value());
    const double B = found->damping_Ns_per_m;
    EXPECT_LT(spectral_radius(mass, N, 0.999 * B), 1.0) << N;
    EXPECT_GT(spectral_radius(mass, N, 1.001 * B), 1.0) << N;
  }
}

TEST(DampingLimit, OfAnUndampedMassIsNearThePaper) {
  for (const double mass_kg : {0.032, 0.052, 0.077}) {
    for (const int N : {50, 100, 200}) {
      const double rule = mass_kg * std::pow(std::numbers::pi, 2) / (2.0 * N * kPeriod);
      const auto found = limit({.mass_kg = mass_kg}, mean_of(N));
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->damping_Ns_per_m / rule, 1.0, 2.5 / N);
      EXPECT_NEAR(found->frequency_Hz, 0.5 / (N * kPeriod), 0.02 * 0.5 / (N * kPeriod));
    }
  }
}

TEST(DampingLimit, AgreesWithTheReferenceValues) {
  const std::filesystem::path file =
      std::filesystem::path{TELEOP_SOURCE_DIR} / "../shared/paper/loop_reference.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  std::ifstream in{file};
  const nlohmann::json reference = nlohmann::json::parse(in);
  int compared = 0;
  for (const auto& row : reference.at("viscous")) {
    const auto delay = row.at("d").get<int>();
    const auto found = [&] {
      const SampledMass mass{.mass_kg = row.at("M"), .damping_Ns_per_m = row.at("b")};
      const auto h = impulse_response(mean_of(row.at("N")));
      const auto delayed = [&](double w) {
        return response(h, kPeriod, w) * std::polar(1.0, -w * delay * kPeriod);
      };
      return damping_limit(mass, delayed, {});
    }();
    ASSERT_TRUE(found.has_value()) << row;
    EXPECT_NEAR(found->damping_Ns_per_m / row.at("B_max").get<double>(), 1.0, 1e-3) << row;
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

struct Oscillation {
  double lever_m = 0.0;
  double amplitude_m = 0.0;
};

/// What is left of an oscillation after eight cycles in the loop itself: mass, encoder with period
/// counter, estimator, held force of damping B.
double amplitude_after(const SampledMass& mass,
                       const EvenVelocity& estimator,
                       const Oscillation& start,
                       const DampingLimit& at,
                       double B) {
  const auto [lever_m, amplitude_m] = start;
  testing::WatchedEncoder encoder;
  VelocityEstimator velocity{estimator.config, JointVector::Constant(estimator.counts_per_rev)};
  const double w = 2.0 * std::numbers::pi * at.frequency_Hz;
  double x = 0.0;
  double v = 0.0;
  double force = 0.0;
  double largest = 0.0;
  const auto turns = static_cast<int>(16.0 / at.frequency_Hz / kPeriod);
  const int driven = turns / 2;
  for (int k = 1; k <= turns; ++k) {
    const double t0 = (k - 1) * kPeriod;
    // Driven along the sine at first, until the estimator has settled.
    const double settled = force / mass.damping_Ns_per_m;
    const double rate = mass.damping_Ns_per_m / mass.mass_kg;
    const auto motion = [&](double t) {
      if (k <= driven) return amplitude_m * std::sin(w * t) / lever_m;
      const double decay = -std::expm1(-rate * (t - t0));
      return (x + settled * (t - t0) + (v - settled) / rate * decay) / lever_m;
    };
    const VelocitySample sample = encoder.read(motion, k * kPeriod);
    const double t1 = k * kPeriod;
    const double next_v = k <= driven ? amplitude_m * w * std::cos(w * t1)
                                      : settled + (v - settled) * std::exp(-rate * kPeriod);
    x = motion(t1) * lever_m;
    v = next_v;
    force = -B * lever_m * velocity.step(sample)[0];
    if (k > turns - static_cast<int>(2.0 / at.frequency_Hz / kPeriod)) {
      largest = std::max(largest, std::abs(v) / w);
    }
  }
  return largest / amplitude_m;
}

TEST(DampingLimit,
     OfADescribingFunctionIsWhereAnOscillationOfThatAmplitudeTurnsFromDyingToGrowing) {
  constexpr double kLever_m = 0.17;
  constexpr double kAmplitude_m = 0.5e-3;
  const SampledMass mass{.mass_kg = 0.032, .damping_Ns_per_m = 1.115};
  for (const char* kind : {"period", "robust_exact", "adaptive_window"}) {
    const EvenVelocity estimator{.config = {.kind = kind},
                                 .counts_per_rev = testing::WatchedEncoder::kCounts};
    const auto H = [&](double w) {
      return describing_function(estimator, kAmplitude_m / kLever_m, w);
    };
    const auto found =
        damping_limit(mass, H, {.lowest_Hz = 1.0, .highest_Hz = 450.0, .points = 60});
    ASSERT_TRUE(found.has_value()) << kind;
    const auto after = [&](double share) {
      return amplitude_after(mass, estimator, {.lever_m = kLever_m, .amplitude_m = kAmplitude_m},
                             *found, share * found->damping_Ns_per_m);
    };
    EXPECT_LT(after(0.85), 0.6) << kind;
    EXPECT_GT(after(1.15), 1.5) << kind;
  }
}

TEST(DampingLimit, IsTheLeastOfAllCrossingsNotTheLowest) {
  // The phase is −180° at every 2π (m + 1/4) of ω (lag + T/2); a peak of 50 stands at the second.
  constexpr double kLag_s = 8e-3;
  constexpr double kMass_kg = 0.05;
  const double second = 2.5 * std::numbers::pi / (kLag_s + kPeriod / 2.0);
  const auto H = [&](double w) {
    const double peak = 1.0 + 50.0 * std::exp(-std::pow((w - second) / 40.0, 2));
    return peak * std::complex<double>{0.0, w} * std::polar(1.0, -w * kLag_s);
  };
  const auto found = damping_limit({.mass_kg = kMass_kg}, H, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->frequency_Hz * 2.0 * std::numbers::pi / second, 1.0, 0.01);
  EXPECT_NEAR(found->damping_Ns_per_m / (kMass_kg * second / 51.0), 1.0, 0.1);
}

TEST(DampingLimit, IsAbsentWhereNothingDestabilises) {
  // An estimate that leads by a whole period: the loop's own hold is made up for.
  const auto leading = [](double w) {
    return std::complex<double>{0.0, w} * std::polar(1.0, 0.55 * w * kPeriod);
  };
  EXPECT_FALSE(
      damping_limit({.mass_kg = 0.05, .damping_Ns_per_m = 1.0}, leading, {.highest_Hz = 200.0})
          .has_value());
}

}  // namespace
}  // namespace teleop
