#include "core/tuning/analytic_margin.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr double kPeriod = 1e-3;

VelocityEstimator::Config mean_of(int samples) {
  return {.kind = "mean", .mean = {.samples = samples}};
}

nlohmann::json reference() {
  std::ifstream in{std::filesystem::path{TELEOP_SOURCE_DIR} /
                   "../shared/paper/loop_reference.json"};
  return in ? nlohmann::json::parse(in) : nlohmann::json{};
}

/// Both methods: the value within 1e-3 by frequency, and the radius on either side of it.
void expect_margin(SampledLoop loop, TunedGain tuned, double gain, const std::string& row) {
  const auto margin = nyquist_margin(loop, tuned);
  ASSERT_TRUE(margin) << row;
  EXPECT_NEAR(margin->gain / gain, 1.0, 1e-3) << row;
  double& tune = tuned == TunedGain::stiffness ? loop.stiffness_N_per_m : loop.damping_Ns_per_m;
  tune = 0.9995 * margin->gain;
  EXPECT_LT(spectral_radius(loop), 1.0) << row;
  tune = 1.0005 * margin->gain;
  EXPECT_GT(spectral_radius(loop), 1.0) << row;
}

TEST(AnalyticMargin, AgreesWithTheReferenceWalls) {
  const auto values = reference();
  if (values.is_null()) GTEST_SKIP() << "no reference values";
  for (const auto& row : values.at("wall")) {
    const LinearAxis::Config arm{.mass_kg = row.at("M"),
                                 .damping_Ns_per_m = row.at("b"),
                                 .delay_s = row.at("d").get<double>() * kPeriod,
                                 .lag_s = row.at("tau")};
    expect_margin({.arms = {arm}}, TunedGain::stiffness, row.at("K_max"), row.dump());
    const auto slow = eigenvalue_margin({.arms = {arm}}, TunedGain::stiffness, 1.0, 1e5);
    ASSERT_TRUE(slow);
    EXPECT_NEAR(slow->gain / row.at("K_max").get<double>(), 1.0, 1e-3) << row;
  }
}

TEST(AnalyticMargin, AgreesWithTheReferenceDampers) {
  const auto values = reference();
  if (values.is_null()) GTEST_SKIP() << "no reference values";
  for (const auto& row : values.at("viscous")) {
    const LinearAxis::Config arm{.mass_kg = row.at("M"),
                                 .damping_Ns_per_m = row.at("b"),
                                 .delay_s = row.at("d").get<double>() * kPeriod};
    expect_margin({.arms = {arm}, .velocity = mean_of(row.at("N"))}, TunedGain::damping,
                  row.at("B_max"), row.dump());
  }
}

TEST(AnalyticMargin, AgreesWithTheReferencePairs) {
  const auto values = reference();
  if (values.is_null()) GTEST_SKIP() << "no reference values";
  for (const auto& row : values.at("teleop")) {
    LinearAxis::Config arm{.mass_kg = row.at("M"),
                           .damping_Ns_per_m = row.at("b_master"),
                           .delay_s = row.at("d").get<double>() * kPeriod,
                           .lag_s = row.at("tau")};
    LinearAxis::Config slave = arm;
    slave.damping_Ns_per_m = row.at("b_slave");
    expect_margin({.arms = {arm, slave}}, TunedGain::stiffness, row.at("G_max"), row.dump());
  }
}

/// M π² / (2 N T) for a velocity known at once [Cavusoglu 2002, section 4.1.2]; holding the force
/// for a period delays it by half of one, as if the mean were over one sample more.
TEST(AnalyticMargin, OfAnUndampedMassIsNearTheClosedForm) {
  const SampledLoop loop{.arms = {LinearAxis::Config{.mass_kg = 0.05, .damping_Ns_per_m = 0.0}},
                         .velocity = mean_of(100)};
  const auto margin = nyquist_margin(loop, TunedGain::damping);
  ASSERT_TRUE(margin);
  const double closed = 0.05 * std::pow(std::numbers::pi, 2) / (2.0 * 100 * kPeriod);
  EXPECT_NEAR(margin->gain / closed, std::pow(100.0 / 101.0, 2), 1e-3);
  EXPECT_NEAR(margin->frequency_Hz, 500.0 / 101.0, 1e-3);
}

TEST(AnalyticMargin, OfAFreeMassUnderASpringIsZero) {
  const SampledLoop loop{.arms = {LinearAxis::Config{.damping_Ns_per_m = 0.0, .lag_s = 1e-4}}};
  EXPECT_EQ(eigenvalue_margin(loop, TunedGain::stiffness, 1.0, 1e4)->gain, 0.0);
}

/// Everything at once: fractional delay, lag, second mass, tendon, both estimators, delayed peer.
SampledLoop random_loop(Random& random) {
  const auto axis = [&] {
    LinearAxis::Config arm{.mass_kg = random.uniform(0.02, 0.1),
                           .damping_Ns_per_m = random.uniform(0.5, 4.0),
                           .delay_s = random.uniform(0.0, 2.9e-3),
                           .lag_s = random.uniform() < 0.5 ? random.uniform(1e-4, 1e-3) : 0.0};
    if (random.uniform() < 0.5) {
      arm.second_mass_kg = random.uniform(0.01, 0.05);
      arm.joint_N_per_m = random.uniform(500.0, 5000.0);
      arm.joint_damping_Ns_per_m = random.uniform(0.3, 1.0);
    }
    if (random.uniform() < 0.3) arm.tendon_N_per_m = random.uniform(5e4, 2e5);
    return arm;
  };
  SampledLoop loop{.arms = {axis()}};
  if (random.uniform() < 0.5) {
    loop.arms.push_back(axis());
    loop.peer_delay_samples = static_cast<int>(random.uniform(0.0, 3.0));
  }
  loop.velocity =
      random.uniform() < 0.5
          ? mean_of(static_cast<int>(random.uniform(2.0, 12.0)))
          : VelocityEstimator::Config{.kind = "difference", .difference = {.cutoff_Hz = 200.0}};
  return loop;
}

TEST(AnalyticMargin, IsTheSameByFrequencyAndByEigenvalues) {
  Random random{77};
  int compared = 0;
  for (int i = 0; i < 25; ++i) {
    SampledLoop loop = random_loop(random);
    for (const TunedGain tuned : {TunedGain::stiffness, TunedGain::damping}) {
      const double from = tuned == TunedGain::stiffness ? 1.0 : 0.02;
      loop.damping_Ns_per_m = tuned == TunedGain::stiffness ? 0.05 : 0.0;
      loop.stiffness_N_per_m = tuned == TunedGain::stiffness ? 0.0 : 2.0;
      const auto eigen = eigenvalue_margin(loop, tuned, from, 1e4 * from);
      const auto nyquist = nyquist_margin(loop, tuned);
      if (!eigen || eigen->gain == 0.0) continue;
      ASSERT_TRUE(nyquist) << i;
      EXPECT_NEAR(nyquist->gain / eigen->gain, 1.0, 1e-5) << i << ' ' << loop.arms.size();
      EXPECT_NEAR(nyquist->frequency_Hz / eigen->frequency_Hz, 1.0, 1e-3) << i;
      ++compared;
    }
  }
  EXPECT_GT(compared, 30);
}

/// Readings of a LinearAxis under the law u = −G y, from a push on.
std::vector<double> readings(const LinearAxis::Config& config, double gain, std::size_t count) {
  LinearAxis axis{config};
  std::vector<double> y;
  for (std::size_t k = 0; k < count; ++k) {
    y.push_back(axis.reading());
    axis.command(k == 0 ? 0.01 : -gain * y.back());
    Duration left{1'000'000};
    while (left > Duration{0}) {
      const Duration piece = std::min(left, axis.until_switch());
      axis.advance(piece);
      left -= piece;
    }
  }
  return y;
}

/// A plant that is simulated tick by tick grows as the largest eigenvalue says.
TEST(SampledLoop, GrowsAsTheSimulatedPlantDoes) {
  Random random{12};
  for (int i = 0; i < 20; ++i) {
    LinearAxis::Config arm{.mass_kg = random.uniform(0.02, 0.1),
                           .damping_Ns_per_m = random.uniform(0.5, 4.0),
                           .delay_s = random.uniform(0.0, 2.9e-3),
                           .lag_s = i % 2 == 0 ? 0.0 : 5e-4};
    if (i % 3 != 0) arm.tendon_N_per_m = random.uniform(2e4, 5e4);
    SampledLoop loop{.arms = {arm}};
    const auto margin = nyquist_margin(loop, TunedGain::stiffness);
    ASSERT_TRUE(margin) << i;
    loop.stiffness_N_per_m = 1.1 * margin->gain;
    constexpr std::size_t kCount = 3000;
    const std::vector<double> y = readings(arm, loop.stiffness_N_per_m, kCount);
    const auto rms = [&](std::size_t from, std::size_t to) {
      double sum = 0.0;
      for (std::size_t k = from; k < to; ++k)
        sum += y[k] * y[k];
      return std::sqrt(sum);
    };
    const double growth = std::log(rms(2000, 3000) / rms(1000, 2000)) / 1000.0;
    EXPECT_NEAR(growth / std::log(spectral_radius(loop)), 1.0, 0.02) << i;
  }
}

}  // namespace
}  // namespace teleop
