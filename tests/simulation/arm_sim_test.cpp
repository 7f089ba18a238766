#include "core/simulation/arm_sim.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "core/model/kinematics.hpp"
#include "tests/simulation/plants.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::phantom;

/// A plant whose joints 2 and 3 hold still by themselves.
PlantSpec steady(double yaw_level = 0.0) {
  PlantSpec plant;
  plant.arm = "phantom-1.5";
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    plant.effects.push_back({.kind = "coulomb_friction",
                             .axis = axis,
                             .parameters = {{"level", axis == 0 ? yaw_level : 10.0}}});
  }
  return plant;
}

/// Reads and writes once a millisecond, as a loop does.
ArmState turn(SimulatedArm& arm, SimulatedClock& clock, const JointVector& tau) {
  const ArmState state = arm.read();
  arm.write(tau);
  clock.sleep_until(clock.now() + 1ms);
  return state;
}

TEST(SimulatedArm, ReadsTheNearestCountOfItsTruePosture) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  for (int tick = 0; tick < 300; ++tick) {
    const ArmState state = turn(arm, clock, {0.02 * std::sin(0.02 * tick), 0.0, 0.0});
    const double counts = arm.true_state().q[0] * 54476.8 / (2.0 * std::numbers::pi);
    EXPECT_EQ(state.counts[0], std::lround(counts));
    EXPECT_NEAR(state.q[0], state.counts[0] * 2.0 * std::numbers::pi / 54476.8, 1e-15);
    EXPECT_EQ(state.stamp, clock.now() - 1ms);
  }
  EXPECT_GT(arm.true_state().q.norm(), 0.001);
}

TEST(SimulatedArm, ReadsExactAnglesWhenItIsNotQuantised) {
  SimulatedClock clock;
  PlantSpec plant = steady();
  plant.sensing.quantised = false;
  SimulatedArm arm{{.plant = plant}, clock};
  arm.amplifiers(true);
  for (int tick = 0; tick < 30; ++tick) {
    turn(arm, clock, {0.01, 0.0, 0.0});
  }
  const ArmState state = arm.read();
  EXPECT_EQ(state.q, arm.true_state().q);
}

TEST(SimulatedArm, SaysWhatItMeasuresAndNoMore) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  for (int tick = 0; tick < 3; ++tick) {
    turn(arm, clock, {0.1, 0.0, 0.0});
  }
  const ArmState state = arm.read();
  EXPECT_TRUE(state.has(ArmFlag::amplifiers_on));
  EXPECT_TRUE(state.has(ArmFlag::has_currents));
  EXPECT_TRUE(state.has(ArmFlag::has_period));
  EXPECT_TRUE(state.has(ArmFlag::has_tool_force));
  EXPECT_FALSE(state.has(ArmFlag::has_temperatures));
  EXPECT_EQ(state.motor_temperature, JointVector::Zero());
  EXPECT_NEAR(state.motor_current[0], 0.1 / (13.3 * 0.0234), 1e-12);
  EXPECT_EQ(arm.info().model, "phantom-1.5");
  EXPECT_TRUE(arm.info().simulated);
}

TEST(SimulatedArm, TimesItsEncoderEdges) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  for (int tick = 0; tick < 50; ++tick) {
    turn(arm, clock, {0.05, 0.0, 0.0});
  }
  const ArmState state = arm.read();
  const double speed = arm.true_state().qd[0];
  const double period = 2.0 * std::numbers::pi / 54476.8 / speed;
  EXPECT_NEAR(state.period_ticks[0], 1e7 * period, 0.01 * 1e7 * period + 1.0);
}

TEST(SimulatedArm, HoldsATorqueUntilTheNextWrite) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  const double M11 = 3.573479925e-3;
  arm.write({0.01, 0.0, 0.0});
  clock.sleep_until(clock.now() + 4ms);
  [[maybe_unused]] ArmState state = arm.read();
  EXPECT_NEAR(arm.true_state().qd[0], 0.01 / M11 * 4e-3, 1e-12);
  arm.write({-0.01, 0.0, 0.0});
  clock.sleep_until(clock.now() + 1ms);
  state = arm.read();
  EXPECT_NEAR(arm.true_state().qd[0], 0.01 / M11 * 3e-3, 1e-12);
}

TEST(SimulatedArm, LetsAWriteActSoManyReadingsLater) {
  for (const int delay : {0, 1, 2, 5}) {
    SimulatedClock clock;
    PlantSpec plant = steady();
    plant.drive.delay_samples = delay;
    SimulatedArm arm{{.plant = plant}, clock};
    arm.amplifiers(true);
    int first_moving = -1;
    for (int tick = 0; tick < 10; ++tick) {
      turn(arm, clock, {0.01, 0.0, 0.0});
      if (first_moving < 0 && arm.true_state().qd[0] > 0.0) first_moving = tick;
    }
    EXPECT_EQ(first_moving, delay + 1) << "written at reading 0, it shows one reading after acting";
  }
}

TEST(SimulatedArm, CutsEachMotorToItsTorqueAndSaysSo) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  turn(arm, clock, {1.0, 0.0, 0.0});
  EXPECT_FALSE(arm.read().has(ArmFlag::torque_cut));
  turn(arm, clock, {5.0, 0.0, 0.0});
  const ArmState state = arm.read();
  EXPECT_TRUE(state.has(ArmFlag::torque_cut));
  EXPECT_NEAR(state.motor_current[0], 1.7157 / (13.3 * 0.0234), 1e-12);
}

TEST(SimulatedArm, CutsTheForceAtTheToolAndKeepsItsDirection) {
  SimulatedClock clock;
  PlantSpec plant = steady();
  plant.drive.max_force_N = 2.0;
  SimulatedArm arm{{.plant = plant}, clock};
  arm.amplifiers(true);
  arm.write(linear_jacobian(phantom(), JointVector::Zero()).transpose() * Vector3{3.0, 4.0, 0.0});
  const ArmState state = arm.read();
  EXPECT_TRUE(state.has(ArmFlag::torque_cut));
  EXPECT_NEAR(state.motor_current[0] * 13.3 * 0.0234, 0.215 * 1.2, 1e-12);
  EXPECT_NEAR(state.motor_current[1] * 11.2 * 0.0234, 0.215 * 1.6, 1e-12);
}

TEST(SimulatedArm, RoundsTorquesToTheConvertersStep) {
  SimulatedClock clock;
  PlantSpec plant = steady();
  plant.drive.torque_command_step_Nm = 0.004;
  SimulatedArm arm{{.plant = plant}, clock};
  arm.amplifiers(true);
  arm.write({0.0103, -0.0099, 0.0019});
  const JointVector current = arm.read().motor_current;
  EXPECT_NEAR(current[0] * 13.3 * 0.0234, 0.012, 1e-12);
  EXPECT_NEAR(current[1] * 11.2 * 0.0234, -0.008, 1e-12);
  EXPECT_EQ(current[2], 0.0);
}

TEST(SimulatedArm, GivesNoTorqueWhileItsAmplifiersAreOff) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  for (int tick = 0; tick < 10; ++tick) {
    turn(arm, clock, {0.1, 0.0, 0.0});
  }
  EXPECT_EQ(arm.true_state().qd[0], 0.0);
  EXPECT_FALSE(arm.read().has(ArmFlag::amplifiers_on));
  arm.amplifiers(true);
  for (int tick = 0; tick < 10; ++tick) {
    turn(arm, clock, {0.1, 0.0, 0.0});
  }
  arm.amplifiers(false);
  EXPECT_EQ(arm.read().motor_current, JointVector::Zero());
  arm.amplifiers(true);
  EXPECT_EQ(arm.read().motor_current, JointVector::Zero()) << "an old torque does not come back";
}

TEST(SimulatedArm, DropsItsTorqueWhenItStarves) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  arm.write({0.01, 0.0, 0.0});
  clock.sleep_until(clock.now() + 20ms);
  EXPECT_EQ(arm.read().fault, Fault::none);
  clock.sleep_until(clock.now() + 30ms);
  const ArmState starved = arm.read();
  EXPECT_EQ(starved.fault, Fault::device_watchdog);
  EXPECT_TRUE(starved.has(ArmFlag::watchdog_tripped));
  EXPECT_NEAR(arm.true_state().qd[0], 0.01 / 3.573479925e-3 * 20e-3, 1e-10)
      << "torque for exactly the timeout";

  arm.write({0.01, 0.0, 0.0});
  EXPECT_EQ(arm.read().fault, Fault::device_watchdog) << "writing alone does not reset it";
  arm.amplifiers(false);
  arm.amplifiers(true);
  EXPECT_EQ(arm.read().fault, Fault::none);
}

TEST(SimulatedArm, DoesNotStarveWithAmplifiersOffOrWithoutAWatchdog) {
  SimulatedClock clock;
  SimulatedArm off{{.plant = steady()}, clock};
  PlantSpec plant = steady();
  plant.watchdog.timeout_ms = 0.0;
  SimulatedArm without{{.plant = plant}, clock};
  without.amplifiers(true);
  clock.sleep_until(clock.now() + 90ms);
  EXPECT_EQ(off.read().fault, Fault::none);
  EXPECT_EQ(without.read().fault, Fault::none);
}

TEST(SimulatedArm, IsUnpluggedAtItsTimeForGood) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady(), .faults = {{SimulatedArm::FaultKind::unplugged, 5ms}}},
                   clock};
  arm.amplifiers(true);
  for (int tick = 0; tick < 5; ++tick) {
    EXPECT_EQ(turn(arm, clock, {0.01, 0.0, 0.0}).fault, Fault::none) << tick;
  }
  for (int tick = 0; tick < 5; ++tick) {
    const ArmState state = turn(arm, clock, {0.01, 0.0, 0.0});
    EXPECT_EQ(state.fault, Fault::device_unplugged);
    EXPECT_EQ(state.flags, 0U);
  }
  EXPECT_NEAR(arm.true_state().qd[0], 0.01 / 3.573479925e-3 * 5e-3, 1e-10);
}

TEST(SimulatedArm, FreezesOneEncoderAndMovesOn) {
  SimulatedClock clock;
  SimulatedArm arm{
      {.plant = steady(), .faults = {{SimulatedArm::FaultKind::frozen_encoder, 20ms, 0}}}, clock};
  arm.amplifiers(true);
  ArmState before;
  for (int tick = 0; tick < 20; ++tick) {
    before = turn(arm, clock, {0.05, 0.0, 0.0});
  }
  ArmState after;
  for (int tick = 0; tick < 20; ++tick) {
    after = turn(arm, clock, {0.05, 0.0, 0.0});
  }
  EXPECT_EQ(after.counts[0], before.counts[0]);
  EXPECT_EQ(after.q[0], before.q[0]);
  EXPECT_EQ(after.period_ticks[0], 0);
  EXPECT_GT(arm.true_state().q[0], before.q[0] + 0.001);
  EXPECT_EQ(after.fault, Fault::none) << "a device does not know that its encoder is frozen";
}

TEST(SimulatedArm, DeliversNotANumberOnDemand) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady(), .faults = {{SimulatedArm::FaultKind::nan_angle, 2ms, 1}}},
                   clock};
  EXPECT_TRUE(turn(arm, clock, JointVector::Zero()).q.allFinite());
  turn(arm, clock, JointVector::Zero());
  EXPECT_TRUE(std::isnan(arm.read().q[1]));
}

TEST(SimulatedArm, TakesATorqueThatIsNotANumberAsNone) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  arm.amplifiers(true);
  arm.write(JointVector::Constant(std::nan("")));
  EXPECT_EQ(arm.read().motor_current, JointVector::Zero());
  EXPECT_TRUE(arm.read().has(ArmFlag::torque_cut));
}

TEST(SimulatedArm, MeasuresTheForceOfHandAndSurface) {
  SimulatedClock clock;
  SimulatedArm arm{
      {.plant = load_plant("phantom-1.5"), .hand = "press", .contact = environment("wall")}, clock};
  for (int tick = 0; tick < 4000; ++tick) {
    turn(arm, clock, JointVector::Zero());
  }
  const auto truth = arm.true_state();
  EXPECT_GT(truth.hand_force.x(), 2.0);
  EXPECT_LT(truth.contact_force.x(), -2.0);
  EXPECT_NEAR((arm.read().tool_force - truth.hand_force - truth.contact_force).norm(), 0.0, 1e-12);
  EXPECT_NEAR((truth.p_BT - tool_position(phantom(), truth.q)).norm(), 0.0, 1e-15);
}

/// Calls at uneven instants, with pauses, as the machine's clock gives them.
std::vector<ArmState> uneven_run(std::uint64_t seed) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = load_plant("phantom-1.5"),
                    .hand = "reach",
                    .contact = environment("soft"),
                    .seed = seed},
                   clock};
  arm.amplifiers(true);
  Random random{9};
  std::vector<ArmState> states;
  for (int tick = 0; tick < 2000; ++tick) {
    states.push_back(arm.read());
    clock.sleep_until(clock.now() + Duration{random.bits() % 100'000});
    arm.write(-2.0 * states.back().q);
    clock.sleep_until(clock.now() + Duration{500'000 + random.bits() % 1'000'000});
  }
  return states;
}

TEST(SimulatedArm, RepeatsItselfToTheBitAtUnevenInstants) {
  const auto one = uneven_run(4);
  const auto two = uneven_run(4);
  const auto other = uneven_run(5);
  bool differs = false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].counts, two[i].counts);
    ASSERT_EQ(one[i].period_ticks, two[i].period_ticks);
    ASSERT_EQ(one[i].tool_force, two[i].tool_force);
    ASSERT_EQ(one[i].stamp, two[i].stamp);
    differs = differs || one[i].counts != other[i].counts;
  }
  EXPECT_TRUE(differs) << "the seed changes the hand";
}

TEST(SimulatedArm, LeavesOutWhatALongPauseWouldCost) {
  SimulatedClock clock;
  SimulatedArm arm{{.plant = steady()}, clock};
  clock.sleep_until(clock.now() + 10s);
  EXPECT_EQ(arm.read().stamp, clock.now());
  EXPECT_EQ(arm.skipped(), 10s - SimulatedArm::kLongestGap);
  clock.sleep_until(clock.now() + 1ms);
  [[maybe_unused]] const ArmState state = arm.read();
  EXPECT_EQ(arm.skipped(), 10s - SimulatedArm::kLongestGap);
}

TEST(SimulatedArm, RefusesWhatItCannotBe) {
  SimulatedClock clock;
  PlantSpec nowhere;
  nowhere.arm = "no-such-arm";
  EXPECT_THROW((SimulatedArm{{.plant = nowhere}, clock}), ConfigError);
  EXPECT_THROW((SimulatedArm{{.hand = "/no/such/trace.csv"}, clock}), ConfigError);
  EXPECT_THROW((SimulatedArm{{.q = {9.0, 0.0, 0.0}}, clock}), ConfigError);
  PlantSpec unknown;
  unknown.effects.push_back({.kind = "magic"});
  EXPECT_THROW((SimulatedArm{{.plant = unknown}, clock}), ConfigError);
  EXPECT_THROW((SimulatedArm{{.faults = {{SimulatedArm::FaultKind::nan_angle, 0ms, 3}}}, clock}),
               ConfigError);
}

TEST(SimulatedArm, TurnsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  SimulatedClock clock;
  SimulatedArm arm{{.plant = load_plant("phantom-1.5"),
                    .hand = "reach",
                    .contact = environment("wall"),
                    .faults = {{SimulatedArm::FaultKind::frozen_encoder, 1s, 0}}},
                   clock};
  const testing::NoAllocation guard;
  arm.amplifiers(true);
  for (int tick = 0; tick < 2000; ++tick) {
    turn(arm, clock, {0.01, 0.0, 0.0});
  }
  [[maybe_unused]] const auto truth = arm.true_state();
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
