#include "core/effects/contact.hpp"

#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

Contact::Config wall() {
  return {.point_m = {0.02, 0.0, 0.0},
          .normal = {-2.0, 0.0, 0.0},
          .stiffness = 1000.0,
          .damping = 10.0};
}

Contact::Config foam() {
  Contact::Config config = wall();
  config.law = Contact::Law::hunt_crossley;
  config.stiffness = 3000.0;
  config.damping = 2.0;
  return config;
}

double force_at(const Contact& contact, double x, double v) {
  return contact.force(contact.depth({x, 0.0, 0.0}, {v, 0.0, 0.0}));
}

TEST(Contact, PushesOutOfAWallWithSpringAndDamper) {
  const Contact contact{wall()};
  EXPECT_NEAR(force_at(contact, 0.025, 0.1), 1000.0 * 0.005 + 10.0 * 0.1, 1e-12);
  EXPECT_EQ(force_at(contact, 0.019, 0.1), 0.0);
  EXPECT_NEAR((contact.depth({0.03, 0.0, 0.0}, {}).normal - Vector3{-1.0, 0.0, 0.0}).norm(), 0.0,
              1e-15);
}

TEST(Contact, PushesOutOfASphereAlongItsRadius) {
  const Contact contact{{.shape = Contact::Shape::sphere,
                         .point_m = {0.1, 0.0, 0.0},
                         .radius_m = 0.05,
                         .stiffness = 1000.0}};
  const Contact::Depth depth = contact.depth({0.1, 0.04, 0.0}, {0.0, -0.2, 0.0});
  EXPECT_NEAR(depth.p, 0.01, 1e-15);
  EXPECT_NEAR(depth.p_rate, 0.2, 1e-15);
  EXPECT_NEAR(contact.force(depth), 10.0, 1e-12);
  EXPECT_NEAR((depth.normal - Vector3::UnitY()).norm(), 0.0, 1e-15);
}

TEST(Contact, FollowsHuntAndCrossley) {
  const Contact contact{foam()};
  EXPECT_NEAR(force_at(contact, 0.03, 0.1), 3000.0 * std::pow(0.01, 1.5) * 1.2, 1e-12);
}

TEST(Contact, NeverPulls) {
  Random random{7};
  for (const Contact::Config& config : {wall(), foam()}) {
    const Contact contact{config};
    for (int i = 0; i < 10000; ++i) {
      EXPECT_GE(force_at(contact, random.uniform(0.0, 0.05), random.uniform(-3.0, 3.0)), 0.0);
    }
  }
}

TEST(Contact, MarginIsPositiveExactlyWhereItPushes) {
  Random random{8};
  for (const Contact::Config& config : {wall(), foam()}) {
    const Contact contact{config};
    for (int i = 0; i < 10000; ++i) {
      const auto depth = contact.depth({random.uniform(0.0, 0.05), 0.0, 0.0},
                                       {random.uniform(-3.0, 3.0), 0.0, 0.0});
      const bool pushes = depth.p > 0.0 && contact.smooth_force(depth) > 0.0;
      EXPECT_EQ(contact.push_margin(depth) > 0.0, pushes) << depth.p << ' ' << depth.p_rate;
    }
  }
}

TEST(Contact, GivesBackNoMoreThanItStores) {
  Random random{9};
  for (const Contact::Config& config : {wall(), foam()}) {
    const Contact contact{config};
    for (int i = 0; i < 10000; ++i) {
      const double x = random.uniform(0.0, 0.05);
      const double v = random.uniform(-3.0, 3.0);
      const double dx = 1e-7 * v;
      const auto before = contact.depth({x - dx, 0.0, 0.0}, {v, 0.0, 0.0});
      const auto after = contact.depth({x + dx, 0.0, 0.0}, {v, 0.0, 0.0});
      const double stored = contact.stored_energy(after) - contact.stored_energy(before);
      EXPECT_LE(stored - 2.0 * dx * force_at(contact, x, v), 1e-10);
    }
  }
}

TEST(Contact, RefusesNumbersThatMakeNoSurface) {
  Contact::Config config = wall();
  config.normal = Vector3::Zero();
  EXPECT_THROW(Contact{config}, ConfigError);
  config = wall();
  config.stiffness = 0.0;
  EXPECT_THROW(Contact{config}, ConfigError);
  config = wall();
  config.damping = -1.0;
  EXPECT_THROW(Contact{config}, ConfigError);
  config = foam();
  config.exponent = 0.5;
  EXPECT_THROW(Contact{config}, ConfigError);
  EXPECT_THROW((Contact{{.shape = Contact::Shape::sphere, .stiffness = 1.0}}), ConfigError);
}

TEST(Environment, IsKnownByName) {
  EXPECT_FALSE(environment("free").has_value());
  EXPECT_TRUE(environment("soft").has_value());
  EXPECT_TRUE(environment("wall").has_value());
  try {
    [[maybe_unused]] const auto none = environment("hard");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string{error.what()}.find("free, soft, wall"), std::string::npos);
  }
}

TEST(Contact, IsEvaluatedWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const Contact contact{foam()};
  const testing::NoAllocation guard;
  [[maybe_unused]] const volatile double f = force_at(contact, 0.03, 0.1);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
