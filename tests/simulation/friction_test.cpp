#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"
#include "tests/simulation/plants.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::only_yaw;
using testing::phantom;
using testing::shipped_friction;

constexpr double kLevel = 0.01;
constexpr JointFriction kDry{.dry_forward = kLevel, .dry_backward = kLevel};

double yaw_inertia() { return mass_matrix(phantom(), JointVector::Zero())(0, 0); }

TEST(StickSlip, StopsExactlyWhenAndWhereTheorySays) {
  constexpr double kSpeed = 0.5;
  const double stop_s = kSpeed * yaw_inertia() / kLevel;
  const double stop_rad = kSpeed * kSpeed * yaw_inertia() / (2.0 * kLevel);
  const auto before = Duration{static_cast<std::int64_t>(stop_s * 1e9)};  // rounded down to 1 ns
  Plant plant{phantom(), {.terms = only_yaw(kDry), .qd = {kSpeed, 0.0, 0.0}}};
  plant.advance(before - 1ns);
  EXPECT_GT(plant.qd()[0], 0.0);
  EXPECT_NEAR(plant.qd()[0], (stop_s - seconds(before - 1ns)) * kLevel / yaw_inertia(), 1e-11);
  plant.advance(2ns);
  EXPECT_EQ(plant.qd()[0], 0.0);
  EXPECT_NEAR(plant.q()[0], stop_rad, 1e-14);
  EXPECT_EQ(plant.sliding()[0], Sliding::stuck);
}

TEST(StickSlip, StaysExactlyAtRestBelowTheLevel) {
  Plant plant{phantom(), {.terms = only_yaw(kDry), .qd = {0.3, 0.0, 0.0}}};
  plant.advance(500ms);
  const JointVector q = plant.q();
  Random random{1};
  for (int tick = 0; tick < 5000; ++tick) {
    plant.set_torque({random.uniform(-kLevel, kLevel), random.uniform(-1.0, 1.0), 0.5});
    plant.advance(1ms);
    ASSERT_EQ(plant.qd(), JointVector::Zero());
    ASSERT_EQ(plant.q(), q);
  }
}

TEST(StickSlip, ComesLooseExactlyAboveTheLevelOfItsDirection) {
  const JointFriction lopsided{.dry_forward = 1.2 * kLevel, .dry_backward = 0.8 * kLevel};
  const double above = 1.0 + 1e-12;
  const auto moves = [&](double torque) {
    Plant plant{phantom(), {.terms = only_yaw(lopsided)}};
    plant.set_torque({torque, 0.0, 0.0});
    plant.advance(10ms);
    return plant.qd()[0];
  };
  EXPECT_EQ(moves(lopsided.dry_forward), 0.0);
  EXPECT_GT(moves(lopsided.dry_forward * above), 0.0);
  EXPECT_EQ(moves(-lopsided.dry_backward), 0.0);
  EXPECT_LT(moves(-lopsided.dry_backward * above), 0.0);
}

TEST(StickSlip, BrakesEachDirectionByItsOwnLevel) {
  const JointFriction lopsided{.dry_forward = 1.2 * kLevel, .dry_backward = 0.8 * kLevel};
  for (const double speed : {0.5, -0.5}) {
    Plant plant{phantom(), {.terms = only_yaw(lopsided), .qd = {speed, 0.0, 0.0}}};
    plant.advance(1s);
    const double level = speed > 0.0 ? lopsided.dry_forward : lopsided.dry_backward;
    EXPECT_NEAR(std::abs(plant.q()[0]), speed * speed * yaw_inertia() / (2.0 * level), 1e-13);
  }
}

TEST(StickSlip, FollowsAsymmetricViscousFrictionThroughATurn) {
  // Thrown forward against a constant torque the joint turns back; both halves are known.
  const JointFriction viscous{.viscous_forward = 0.06, .viscous_backward = 0.02};
  constexpr double kTorque = -0.05;
  Plant plant{phantom(), {.terms = only_yaw(viscous), .qd = {1.0, 0.0, 0.0}}};
  plant.set_torque({kTorque, 0.0, 0.0});
  const double M = yaw_inertia();
  const double b = viscous.viscous_forward;
  const double turn_s = M / b * std::log1p(-b / kTorque);
  plant.advance(100ms);
  const double after = 0.1 - turn_s;
  const double c = viscous.viscous_backward;
  EXPECT_NEAR(plant.qd()[0], kTorque / c * (1.0 - std::exp(-c / M * after)), 1e-8);
}

TEST(StickSlip, ComesLooseWithinAStepWhenAHandPullsEverHarder) {
  // The hand goes half a metre in five seconds: its spring reaches the level at a known instant.
  constexpr double kWay = 0.5;
  constexpr double kStiffness = 5.0;
  const double lever = phantom().parameters().l1_m;
  const Hand hand{{.stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0.0, .mass_kg = 0.0},
                  PointMotion{Vector3::Zero(), {kWay, 0.0, 0.0}, 5s}};
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2.0;
    (kStiffness * kWay * minimum_jerk(middle) * lever < kLevel ? low : high) = middle;
  }
  Plant plant{phantom(), {.terms = only_yaw(kDry), .hand = hand}};
  const auto loose = Duration{static_cast<std::int64_t>(5e9 * low)};  // rounded down to 1 ns
  plant.advance(loose - 1ns);
  EXPECT_EQ(plant.sliding()[0], Sliding::stuck);
  EXPECT_EQ(plant.q()[0], 0.0);
  plant.advance(3ns);
  EXPECT_EQ(plant.sliding()[0], Sliding::forward);
  // Soon after the torque grows at a constant rate: the angle grows with t³.
  plant.advance(500us);
  const double t = seconds(plant.time()) - 5.0 * low;
  const double torque_rate = kStiffness * lever * kWay / 5.0 * minimum_jerk_rate(low);
  EXPECT_NEAR(plant.q()[0], torque_rate / yaw_inertia() * t * t * t / 6.0, 1e-12);
}

TEST(StickSlip, FindsStopsThatAreShorterThanAStep) {
  // Drawn by a spring at a speed that falls a little, the joint swings about that speed from rest
  // to twice of it and back to just below rest: once a swing it stops, for a fifth of a
  // millisecond.
  constexpr double kSpeed = 0.0043;
  std::vector<HandKnot> line;
  for (double t = 0.0; t < 3.0; t += 1e-3) {
    constexpr double kFall = 0.002;
    line.push_back({.p = {kSpeed * (t - kFall * t * t / 2.0), 0.0, 0.0},
                    .v = {kSpeed * (1.0 - kFall * t), 0.0, 0.0}});
  }
  Plant::Config config{
      .terms = only_yaw({.dry_forward = 0.1, .dry_backward = 0.1}),
      .hand = Hand{{.stiffness_N_per_m = 2000.0, .damping_Ns_per_m = 0.0, .mass_kg = 0.0},
                   RepeatedMotion{Vector3::Zero(), line}}};
  Plant coarse{phantom(), config};
  config.max_step = 20us;
  Plant fine{phantom(), config};
  coarse.advance(3s);
  fine.advance(3s);
  EXPECT_GT(fine.events(), 60U);
  EXPECT_EQ(coarse.events(), fine.events());
  EXPECT_NEAR(coarse.q()[0], fine.q()[0], 1e-4 * testing::kCount);
}

TEST(StickSlip, DragsAStuckNeighbourOnlyWhenCouplingExceedsItsLevel) {
  // Joints 2 and 3 are coupled by M23 away from q2 = q3.
  const JointVector q{0.0, 0.4, -0.2};
  PlantTerms terms = shipped_friction();
  Plant plant{phantom(), {.terms = terms, .q = q}};
  const JointVector weight = gravity_torque(phantom(), q);
  plant.set_torque(weight + JointVector{0.0, 0.0086 + 0.001, 0.0});
  EXPECT_EQ(plant.sliding()[1], Sliding::forward);
  EXPECT_EQ(plant.sliding()[2], Sliding::stuck);
  plant.set_torque(weight + JointVector{0.0, 0.5, 0.0});
  EXPECT_EQ(plant.sliding()[1], Sliding::forward);
  EXPECT_NE(plant.sliding()[2], Sliding::stuck);
}

/// Modes must satisfy the law that defines them, for any inertia, load and levels.
TEST(Friction, ModesAgreeWithThemselves) {
  Random random{5};
  int stuck = 0;
  for (int i = 0; i < 20'000; ++i) {
    RigidBody::Inertia body;
    body.M11 = random.uniform(1e-3, 5e-3);
    body.M22 = random.uniform(1e-3, 5e-3);
    body.M33 = random.uniform(1e-3, 5e-3);
    body.M23 = random.uniform(-0.9, 0.9) * std::sqrt(body.M22 * body.M33);
    std::array<JointFriction, kJoints> friction{};
    JointVector net;
    JointVector qd;
    for (std::size_t k = 0; k < kJoints; ++k) {
      friction.at(k) = {.dry_forward = random.uniform(0.0, 0.1),
                        .dry_backward = random.uniform(0.0, 0.1)};
      net[static_cast<Eigen::Index>(k)] = random.uniform(-0.15, 0.15);
      qd[static_cast<Eigen::Index>(k)] = random.uniform() < 0.8 ? 0.0 : random.normal();
    }
    const SlidingModes modes = resolve_friction(body, friction, qd, net);
    const Acceleration motion = accelerate(body, friction, net, modes);
    for (std::size_t k = 0; k < kJoints; ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      const auto sign = static_cast<double>(modes.at(k));
      if (qd[joint] != 0.0) {
        EXPECT_GT(sign * qd[joint], 0.0);
      } else if (modes.at(k) == Sliding::stuck) {
        ++stuck;
        EXPECT_EQ(motion.qdd[joint], 0.0);
        EXPECT_LE(motion.hold[joint], friction.at(k).dry_forward);
        EXPECT_GE(motion.hold[joint], -friction.at(k).dry_backward);
      } else {
        EXPECT_GE(sign * motion.qdd[joint], 0.0);
      }
    }
  }
  EXPECT_GT(stuck, 5000);
}

TEST(StickSlip, PassesThroughManyEventsWithoutLosingItself) {
  // Tiny dry friction, a stiff ball and torques that change sign at every tick.
  PlantTerms terms;
  for (JointFriction& each : terms.friction) {
    each = {1e-6, 2e-6, 0.0, 1e-4};
  }
  const Contact ball{{.shape = Contact::Shape::sphere,
                      .point_m = {0.01, 0.0, 0.0},
                      .radius_m = 0.0099,
                      .stiffness = 1e6,
                      .damping = 100.0}};
  Plant plant{phantom(), {.terms = terms, .contact = ball}};
  Random random{6};
  for (int tick = 0; tick < 2000; ++tick) {
    plant.set_torque(
        {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)});
    plant.advance(1ms);
    ASSERT_TRUE(plant.q().allFinite());
  }
  EXPECT_GT(plant.events(), 200U);
}

TEST(StickSlip, GoesOnThroughMoreEventsThanItLocates) {
  // Pushed against an undamped, absurdly hard wall the tool bounces every fraction of a
  // microsecond.
  const Contact wall{{.point_m = {1e-15, 0.0, 0.0}, .normal = {-1.0, 0.0, 0.0}, .stiffness = 1e13}};
  Plant plant{phantom(), {.terms = only_yaw({}), .contact = wall}};
  plant.set_torque({0.5, 0.0, 0.0});
  plant.advance(2ms);
  EXPECT_EQ(plant.time(), 2ms);
  EXPECT_TRUE(plant.q().allFinite());
  EXPECT_GT(plant.events(), 1000U);
  EXPECT_LT(std::abs(plant.q()[0]), 1e-3);
}

}  // namespace
}  // namespace teleop
