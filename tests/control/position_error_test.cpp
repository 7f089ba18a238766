#include "core/control/position_error.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using Config = PositionError::Config;
using Motion = PositionError::Motion;

constexpr int kCases = 1000;

Vector3 any_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Motion any_motion(Random& random) { return {any_vector(random, 0.1), any_vector(random, 1.0)}; }

/// Any scale, force gain and rotation; the master's gains make the coupling passive.
Config any_passive(Random& random) {
  Config c;
  c.scale = random.uniform(0.2, 5.0);
  c.force_gain = random.uniform(0.2, 5.0);
  c.stiffness_slave_N_per_m = random.uniform(10.0, 3000.0);
  c.damping_slave_Ns_per_m = random.uniform(0.1, 10.0);
  c.stiffness_master_N_per_m = c.scale * c.scale * c.stiffness_slave_N_per_m / c.force_gain;
  c.damping_master_Ns_per_m = c.scale * c.scale * c.damping_slave_Ns_per_m / c.force_gain;
  c.rotation_rad = {random.uniform(-3.0, 3.0), random.uniform(-1.5, 1.5),
                    random.uniform(-3.0, 3.0)};
  return c;
}

/// Power that the coupling gives to both tools.
double power_out(const Config& config, const Motion& m, const Motion& s) {
  const auto at_master = PositionError{config, Role::master}.step(m, s);
  const auto at_slave = PositionError{config, Role::slave}.step(s, m);
  return at_master.force.dot(m.velocity) + at_slave.force.dot(s.velocity);
}

TEST(PositionError, PullsBothToolsTogetherInThePapersCase) {
  const Config config{.stiffness_master_N_per_m = 1000.0,
                      .stiffness_slave_N_per_m = 1000.0,
                      .damping_master_Ns_per_m = 0.0,
                      .damping_slave_Ns_per_m = 0.0};
  const Motion m{.displacement = {0.002, 0.0, 0.0}};
  const Motion s{.displacement = {0.0, 0.001, 0.0}};

  const auto at_slave = PositionError{config, Role::slave}.step(s, m);
  const auto at_master = PositionError{config, Role::master}.step(m, s);

  EXPECT_NEAR((at_slave.force - Vector3{2.0, -1.0, 0.0}).norm(), 0.0, 1e-12);
  EXPECT_NEAR((at_master.force + at_slave.force).norm(), 0.0, 1e-12);
  EXPECT_EQ(at_master.error, at_slave.error);
}

TEST(PositionError, StoresItsStiffnessPowerAsASpringExactlyWhenBalanced) {
  Random random{2};
  for (int i = 0; i < kCases; ++i) {
    Config config = any_passive(random);
    config.damping_master_Ns_per_m = config.damping_slave_Ns_per_m = 0.0;
    const Motion m = any_motion(random);
    const Motion s = any_motion(random);
    const auto at_slave = PositionError{config, Role::slave}.step(s, m);
    const double stored = config.stiffness_slave_N_per_m * at_slave.error.dot(at_slave.error_rate);

    ASSERT_TRUE(passive(config));
    ASSERT_NEAR(power_out(config, m, s), -stored, 1e-9 * (1.0 + std::abs(stored)));

    config.force_gain *= 1.01;
    ASSERT_FALSE(passive(config));
    ASSERT_GT(std::abs(power_out(config, m, s) + stored), 1e-9 * std::abs(stored));
  }
}

TEST(PositionError, BurnsItsDampingPowerExactlyWhenBalanced) {
  Random random{3};
  for (int i = 0; i < kCases; ++i) {
    Config config = any_passive(random);
    config.stiffness_master_N_per_m = config.stiffness_slave_N_per_m = 0.0;
    const Motion m = any_motion(random);
    const Motion s = any_motion(random);
    const auto at_slave = PositionError{config, Role::slave}.step(s, m);
    const double burnt = config.damping_slave_Ns_per_m * at_slave.error_rate.squaredNorm();
    ASSERT_NEAR(power_out(config, m, s), -burnt, 1e-9 * (1.0 + burnt));
  }
}

TEST(PositionError, GeneratesEnergyOnAClosedPathWhenOutOfBalance) {
  // Both tools go around circles of the same size, the slave a quarter turn behind.
  const Config config{.stiffness_master_N_per_m = 500.0,
                      .stiffness_slave_N_per_m = 1000.0,
                      .damping_master_Ns_per_m = 0.0,
                      .damping_slave_Ns_per_m = 0.0};
  const auto round_trip = [&](double lag) {
    double energy = 0.0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kSteps;
      const auto circle = [](double angle) {
        return Motion{.displacement = {std::cos(angle), std::sin(angle), 0.0},
                      .velocity = {-std::sin(angle), std::cos(angle), 0.0}};
      };
      energy += power_out(config, circle(a), circle(a - lag));
    }
    return energy;
  };
  EXPECT_GT(std::max(round_trip(0.5), round_trip(-0.5)), 0.0);
}

TEST(PositionError, TurnsAndScalesTheMasterIntoTheSlavesBase) {
  const Config config{.stiffness_slave_N_per_m = 1.0,
                      .damping_slave_Ns_per_m = 0.0,
                      .scale = 2.0,
                      .rotation_rad = {0.0, 0.0, std::numbers::pi / 2.0}};
  const Motion m{.displacement = {1.0, 0.0, 0.0}};
  const auto at_slave = PositionError{config, Role::slave}.step({}, m);
  EXPECT_NEAR((at_slave.force - Vector3{0.0, 2.0, 0.0}).norm(), 0.0, 1e-12);
}

TEST(PositionError, FeedsTheScaledForceBackInTheMastersBase) {
  const Config config{.stiffness_master_N_per_m = 100.0,
                      .damping_master_Ns_per_m = 0.0,
                      .scale = 2.0,
                      .force_gain = 0.5,
                      .rotation_rad = {0.0, 0.0, std::numbers::pi / 2.0}};
  const Motion s{.displacement = {0.0, 0.04, 0.0}};  // e = −0.04 m along the slave's y
  const auto at_master = PositionError{config, Role::master}.step({}, s);
  EXPECT_NEAR((at_master.force - Vector3{1.0, 0.0, 0.0}).norm(), 0.0, 1e-12);
}

TEST(PositionError, SaysWhetherItIsPassiveAndWhy) {
  Config config{.stiffness_master_N_per_m = 1200.0, .stiffness_slave_N_per_m = 1200.0};
  EXPECT_TRUE(passive(config));
  EXPECT_NE(passivity_statement(config).find("is passive: k_f G_m = 1200 = s² G_s = 1200"),
            std::string::npos);
  config.scale = 2.0;
  EXPECT_FALSE(passive(config));
  EXPECT_NE(passivity_statement(config).find("NOT passive: k_f G_m = 1200 ≠ s² G_s = 4800"),
            std::string::npos);
  config.force_gain = 4.0;
  EXPECT_TRUE(passive(config));
  config.damping_master_Ns_per_m = 0.0;
  EXPECT_FALSE(passive(config)) << "a damper on one side only pushes the other side";
}

TEST(PositionError, RejectsGainsThatCannotBe) {
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((PositionError{{.stiffness_slave_N_per_m = -1.0}, Role::slave}), ConfigError);
  EXPECT_THROW((PositionError{{.damping_master_Ns_per_m = not_a_number}, Role::slave}),
               ConfigError);
  EXPECT_THROW((PositionError{{.scale = 0.0}, Role::slave}), ConfigError);
  EXPECT_THROW((PositionError{{.rotation_rad = {not_a_number, 0.0, 0.0}}, Role::slave}),
               ConfigError);
}

TEST(PositionError, TakesItsGainsFromSettings) {
  Config config;
  Settings settings;
  add_settings(settings, "law.", config);
  settings.load_text("[law]\nstiffness_slave_N_per_m = 5\nrotation_rad = [0, 0.1, 0]\n", "a.toml");
  EXPECT_EQ(config.stiffness_slave_N_per_m, 5.0);
  EXPECT_EQ(config.rotation_rad[1], 0.1);
  EXPECT_THROW(settings.set("law.stiffness_master_N_per_m", "-1", "command line"), ConfigError);
}

TEST(PositionError, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const PositionError law{{}, Role::master};
  const testing::NoAllocation guard;
  [[maybe_unused]] const auto coupling = law.step({}, {});
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
