#include "core/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "tests/simulation/plants.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::kCount;
using testing::only_yaw;
using testing::phantom;
using testing::shipped_friction;

/// A joint controller at 1 kHz, so that the arm works against weight, hand and surface.
JointVector command(const Plant& plant, int tick) {
  const double t = 1e-3 * tick;
  const JointVector target{0.06 * std::sin(5.0 * t), 0.02 * std::sin(7.0 * t),
                           0.02 * std::cos(11.0 * t)};
  return 5.0 * (target - plant.q()) - 0.02 * plant.qd();
}

/// Largest distance of the angles of two plants at the ticks of a run of that many milliseconds.
double distance(const Plant::Config& config, Duration step, Duration finer, int ticks) {
  Plant::Config coarse = config;
  coarse.max_step = step;
  Plant::Config fine = config;
  fine.max_step = finer;
  Plant one{phantom(), coarse};
  Plant two{phantom(), fine};
  double worst = 0.0;
  for (int tick = 0; tick < ticks; ++tick) {
    one.set_torque(command(one, tick));
    two.set_torque(command(two, tick));
    one.advance(1ms);
    two.advance(1ms);
    worst = std::max(worst, (one.q() - two.q()).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(Plant, IsOfOrderFourWhereNothingHappens) {
  PlantTerms viscous;
  for (JointFriction& each : viscous.friction) {
    each = {0.0, 0.0, 0.003, 0.003};
  }
  const Plant::Config config{.terms = viscous, .stops = false, .qd = {3.0, -2.0, 4.0}};
  std::vector<JointVector> ends;
  for (const Duration step : {8ms, 4ms, 2ms, 1ms}) {
    Plant::Config each = config;
    each.max_step = step;
    Plant plant{phantom(), each};
    plant.advance(320ms);
    ends.push_back(plant.q());
  }
  const double one = (ends[1] - ends[0]).norm();
  const double two = (ends[2] - ends[1]).norm();
  const double three = (ends[3] - ends[2]).norm();
  EXPECT_GT(std::log2(one / two), 3.8);
  EXPECT_GT(std::log2(two / three), 3.8);
  EXPECT_LT(std::log2(two / three), 4.4);
}

TEST(Plant, ErrsFarLessThanACountInTenSecondsOfStickSlipHandAndContact) {
  for (const char* hand : {"none", "reach", "press"}) {
    for (const char* surface : {"free", "soft", "wall"}) {
      const Plant::Config config{.terms = shipped_friction(),
                                 .hand = make_hand(hand, phantom(), Vector3::Zero(), 1, {}),
                                 .contact = environment(surface)};
      EXPECT_LT(distance(config, Plant::Config{}.max_step, 62'500ns, 10'000), 0.001 * kCount)
          << hand << " on " << surface;
    }
  }
}

TEST(Plant, ConvergesWithItsStepInSpiteOfEvents) {
  const Plant::Config config{.terms = shipped_friction(),
                             .hand = make_hand("reach", phantom(), Vector3::Zero(), 2, {}),
                             .contact = environment("wall")};
  const double coarse = distance(config, 250us, 7812ns, 3000);
  const double fine = distance(config, 62'500ns, 7812ns, 3000);
  EXPECT_LT(fine, coarse / 50.0) << coarse << ' ' << fine;
  EXPECT_LT(fine, 1e-9);
}

TEST(Plant, FindsTouchesThatAreShorterThanAStep) {
  // A tool thrown at a wall that just reaches it and falls back.
  constexpr double kTorque = -0.5;
  constexpr double kSpeed = 1.0;
  const double M11 = mass_matrix(phantom(), JointVector::Zero())(0, 0);
  const double lever = phantom().parameters().l1_m;
  const double farthest = lever * std::sin(-kSpeed * kSpeed * M11 / (2.0 * kTorque));
  for (const double graze : {1e-7, 3e-7, 1e-6, 2e-6}) {
    Plant::Config config{.terms = only_yaw({}),
                         .contact = Contact{{.point_m = {farthest - graze, 0.0, 0.0},
                                             .normal = {-1.0, 0.0, 0.0},
                                             .stiffness = 1e4}},
                         .qd = {kSpeed, 0.0, 0.0}};
    Plant coarse{phantom(), config};
    config.max_step = 10us;
    Plant fine{phantom(), config};
    for (Plant* plant : {&coarse, &fine}) {
      plant->set_torque({kTorque, 0.0, 0.0});
      for (int tick = 0; tick < 12; ++tick) {
        plant->advance(1ms);
      }
    }
    EXPECT_EQ(coarse.events(), 2U);
    EXPECT_NEAR(coarse.q()[0], fine.q()[0], 1e-4 * kCount) << graze;
    EXPECT_NEAR(coarse.qd()[0], fine.qd()[0], 1e-6) << graze;
  }
}

TEST(Plant, FollowsTheModelsForwardDynamics) {
  Random random{3};
  for (int i = 0; i < 200; ++i) {
    const JointVector q{random.uniform(-1.0, 1.0), random.uniform(-0.4, 0.4),
                        random.uniform(-0.4, 0.4)};
    const JointVector qd{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0),
                         random.uniform(-3.0, 3.0)};
    const JointVector tau{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                          random.uniform(-1.0, 1.0)};
    Plant plant{phantom(), {.q = q, .qd = qd}};
    plant.set_torque(tau);
    const JointVector expected = forward_dynamics(phantom(), q, qd, tau);
    EXPECT_NEAR((plant.qdd() - expected).norm(), 0.0, 1e-11 * expected.norm());
  }
}

TEST(Plant, KeepsTheEnergyOfABareArm) {
  Plant plant{phantom(), {.stops = false, .qd = {4.0, -3.0, 2.0}}};
  const double before = plant.energy();
  for (int i = 0; i < 10'000; ++i) {
    plant.advance(1ms);
  }
  EXPECT_NEAR(plant.energy(), before, 1e-7 * std::abs(before));
}

TEST(Plant, SlowsDownExponentiallyUnderViscousFriction) {
  constexpr double kB = 0.05;
  Plant plant{phantom(),
              {.terms = only_yaw({0.0, 0.0, kB, kB}), .stops = false, .qd = {2.0, 0.0, 0.0}}};
  const double M11 = mass_matrix(phantom(), JointVector::Zero())(0, 0);
  for (int tick = 1; tick <= 200; ++tick) {
    plant.advance(1ms);
    const double left = std::exp(-kB / M11 * 1e-3 * tick);
    EXPECT_NEAR(plant.qd()[0], 2.0 * left, 1e-8);
    EXPECT_NEAR(plant.q()[0], 2.0 * M11 / kB * (1.0 - left), 1e-9);
  }
}

/// Energy of a plant left to itself must never grow, whatever the step.
void expect_no_energy(Plant::Config config, const std::function<void(Plant::Config&)>& alter) {
  for (const Duration step : {100us, 500us, 1000us, 2000us}) {
    for (const Duration span : {137us, 1000us, 7300us}) {
      alter(config);
      config.max_step = step;
      Plant plant{phantom(), config};
      double before = plant.energy();
      for (Duration t{}; t < 1s; t += span) {
        plant.advance(span);
        ASSERT_LE(plant.energy(), before + 1e-10) << step.count() << ' ' << plant.time().count();
        before = plant.energy();
      }
    }
  }
}

TEST(Plant, GainsNoEnergyFromFriction) {
  PlantTerms lopsided = shipped_friction();
  lopsided.friction[1].dry_forward *= 1.4;
  lopsided.friction[2].viscous_backward *= 0.5;
  expect_no_energy({.terms = lopsided},
                   [](Plant::Config& config) { config.qd = {3.0, -4.0, 5.0}; });
}

TEST(Plant, GainsNoEnergyFromSurfaces) {
  for (const char* name : {"wall", "soft"}) {
    expect_no_energy({.terms = only_yaw({}), .contact = environment(name)},
                     [](Plant::Config& config) { config.qd = {2.0, 0.0, 0.0}; });
  }
  const Contact ball{{.shape = Contact::Shape::sphere,
                      .point_m = {0.06, 0.005, 0.0},
                      .radius_m = 0.03,
                      .stiffness = 2000.0,
                      .damping = 1.0}};
  expect_no_energy({.contact = ball}, [](Plant::Config& config) { config.qd = {2.0, 0.5, 0.0}; });
}

TEST(Plant, GainsNoEnergyFromAHandThatRests) {
  expect_no_energy({.terms = shipped_friction()}, [](Plant::Config& config) {
    config.hand = make_hand("hold", phantom(), {0.03, 0.02, -0.02}, 1, {});
    config.qd = {1.0, -2.0, 1.0};
  });
}

TEST(Plant, GainsNoEnergyFromJointStops) {
  expect_no_energy({}, [](Plant::Config& config) { config.qd = {8.0, 6.0, -7.0}; });
}

TEST(Plant, BalancesTheWorkOfMotorsAgainstEnergyAndFriction) {
  constexpr double kTorque = 0.02;
  Plant plant{phantom(), {.terms = only_yaw({0.008, 0.008, 0.0, 0.0})}};
  plant.set_torque({kTorque, 0.0, 0.0});
  const double before = plant.energy();
  plant.advance(300ms);
  const double work = (kTorque - 0.008) * plant.q()[0];
  EXPECT_NEAR(plant.energy() - before, work, 1e-12);
}

TEST(Plant, CannotLeaveItsPostureLimits) {
  Random random{4};
  const ArmParameters& limits = phantom().parameters();
  const auto most = Eigen::Map<const JointVector>(limits.max_torque_Nm.data());
  double worst = 0.0;
  double fastest = 0.0;
  for (int run = 0; run < 30; ++run) {
    Plant plant{phantom(), {}};
    for (int tick = 0; tick < 400; ++tick) {
      if (tick % 100 == 0) {
        const JointVector side{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                               random.uniform(-1.0, 1.0)};
        plant.set_torque(side.cwiseSign().cwiseProduct(most));
      }
      plant.advance(1ms);
      fastest = std::max(fastest, plant.qd().cwiseAbs().maxCoeff());
      const JointStops stops{phantom(), true, {}};
      worst = std::max(worst, stops.deepest(plant.q()));
    }
  }
  RecordProperty("deepest_rad", std::to_string(worst));
  EXPECT_GT(worst, 0.0) << "no stop was reached";
  EXPECT_LT(worst, 0.06) << "at up to " << fastest << " rad/s";
}

TEST(Plant, RestsOnAStopUnderFullTorqueWithinAThousandthOfARadian) {
  Plant plant{phantom(), {.terms = shipped_friction()}};
  plant.set_torque({1.7157, 0.0, 0.0});
  for (int tick = 0; tick < 2000; ++tick) {
    plant.advance(1ms);
  }
  const double past = plant.q()[0] - phantom().parameters().upper_limit_rad[0];
  EXPECT_GT(past, 0.0);
  EXPECT_LT(past, 1e-3);
}

TEST(Plant, GivesTheForceOfTheHandOnTheToolWithItsInertia) {
  // A hand without stiffness and damping is nothing but its mass: f = −m a.
  const Hand mass{{.stiffness_N_per_m = 0.0, .damping_Ns_per_m = 0.0, .mass_kg = 0.05},
                  PointMotion{Vector3::Zero(), Vector3::Zero(), 1s}};
  Plant plant{phantom(), {.hand = mass, .stops = false, .qd = {2.0, 1.0, -1.0}}};
  plant.advance(100ms);
  const JointVector without = forward_dynamics(
      phantom(), plant.q(), plant.qd(),
      linear_jacobian(phantom(), plant.q()).transpose() * plant.tool_forces().hand);
  EXPECT_NEAR((without - plant.qdd()).norm(), 0.0, 1e-10);
}

TEST(Plant, SettlesWhereHandAndWallBalance) {
  PlantTerms viscous;
  for (JointFriction& each : viscous.friction) {
    each = {0.0, 0.0, 0.05, 0.05};
  }
  Plant plant{phantom(),
              {.terms = viscous,
               .hand = make_hand("press", phantom(), Vector3::Zero(), 1, {}),
               .contact = environment("wall")}};
  for (int tick = 0; tick < 10'000; ++tick) {
    plant.advance(1ms);
  }
  const Plant::ToolForces forces = plant.tool_forces();
  const JointVector torque =
      linear_jacobian(phantom(), plant.q()).transpose() * (forces.hand + forces.contact);
  EXPECT_NEAR((torque - gravity_torque(phantom(), plant.q())).norm(), 0.0, 1e-6);
  EXPECT_NEAR(forces.contact.x(), -3.0 / (1.0 + 300.0 / 1e4), 0.05);
}

TEST(Plant, TakesTheSameTimeInOneAdvanceOrMany) {
  const Plant::Config config{.terms = shipped_friction(),
                             .hand = make_hand("reach", phantom(), Vector3::Zero(), 5, {}),
                             .contact = environment("wall")};
  Plant whole{phantom(), config};
  Plant parts{phantom(), config};
  whole.advance(3s);
  for (int i = 0; i < 3000; ++i) {
    parts.advance(300us);
    parts.advance(700us);
  }
  EXPECT_EQ(whole.time(), parts.time());
  EXPECT_NEAR((whole.q() - parts.q()).norm(), 0.0, 0.001 * kCount);
}

TEST(Plant, RepeatsItselfToTheBit) {
  const Plant::Config config{.terms = shipped_friction(),
                             .hand = make_hand("reach", phantom(), Vector3::Zero(), 5, {}),
                             .contact = environment("soft")};
  Plant one{phantom(), config};
  Plant two{phantom(), config};
  for (int tick = 0; tick < 3000; ++tick) {
    one.set_torque(command(one, tick));
    two.set_torque(command(two, tick));
    one.advance(1ms);
    two.advance(1ms);
    ASSERT_EQ(one.q(), two.q());
    ASSERT_EQ(one.qd(), two.qd());
  }
}

TEST(Plant, AdvancesWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Plant plant{phantom(),
              {.terms = shipped_friction(),
               .hand = make_hand("reach", phantom(), Vector3::Zero(), 5, {}),
               .contact = environment("wall")}};
  Sensing edges{{}, {54476.8, 45875.2, 45875.2}, plant.q()};
  const testing::NoAllocation guard;
  for (int tick = 0; tick < 2000; ++tick) {
    plant.set_torque(command(plant, tick));
    plant.advance(1ms, &edges);
    [[maybe_unused]] const auto forces = plant.tool_forces();
    [[maybe_unused]] const auto energy = plant.energy();
  }
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(plant.events(), 10U);
}

}  // namespace
}  // namespace teleop
