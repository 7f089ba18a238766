#include "core/simulation/pair.hpp"

#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

SimulatedPair::Config pair_with(const std::string& hand, const std::string& surroundings = "free") {
  const PlantSpec plant = load_plant("phantom-1.5");
  return {.master = {.plant = plant, .hand = hand},
          .slave = {.plant = plant, .contact = environment(surroundings)}};
}

/// What a run of the pair showed, over the turns on which both were engaged.
struct Observed {
  double tracking_rms_mm = 0.0;
  double peak_speed_m_per_s = 0.0;
  double largest_force_step_N = 0.0;
  int engaged_turns = 0;
};

Observed observe(SimulatedPair& pair, int turns) {
  Observed seen;
  Vector3 last = Vector3::Zero();
  for (int i = 0; i < turns; ++i) {
    pair.step();
    seen.largest_force_step_N =
        std::max(seen.largest_force_step_N, (pair.slave().coupling_N - last).norm());
    last = pair.slave().coupling_N;
    if (pair.master().mode != static_cast<std::uint32_t>(Mode::engaged) ||
        pair.master().epoch != pair.slave().epoch) {
      continue;
    }
    ++seen.engaged_turns;
    seen.tracking_rms_mm += 1e6 * pair.slave().error_m.squaredNorm();
    seen.peak_speed_m_per_s = std::max(seen.peak_speed_m_per_s, pair.master().v_m_per_s.norm());
  }
  seen.tracking_rms_mm = std::sqrt(seen.tracking_rms_mm / std::max(1, seen.engaged_turns));
  return seen;
}

TEST(Pair, FollowsAReachingHandWithinTwoMillimetres) {
  SimulatedPair pair{pair_with("reach")};

  const Observed seen = observe(pair, 10'000);

  EXPECT_GT(seen.engaged_turns, 9'500);
  EXPECT_GT(seen.peak_speed_m_per_s, 0.1) << "the hand hardly moved";
  EXPECT_LT(seen.tracking_rms_mm, 2.0);
}

TEST(Pair, LetsTheHandFeelTheWallAtRest) {
  SimulatedPair pair{pair_with("press", "wall")};
  for (int i = 0; i < 6'000; ++i)
    pair.step();

  const double hand = pair.master_arm().true_state().hand_force.norm();
  const double wall = pair.slave_arm().true_state().contact_force.norm();

  EXPECT_GT(wall, 0.5) << "nothing is pressed";
  EXPECT_NEAR(hand / wall, 1.0, 0.1);
}

TEST(Pair, RecordsTheToolAccelerometerOfAnArmThatHasOne) {
  SimulatedPair::Config config = pair_with("reach");
  config.master.plant.effects.push_back(
      {.kind = "tool_accelerometer",
       .parameters = {{"noise", 0.01}, {"bandwidth_Hz", 500.0}, {"range", 160.0}}});
  SimulatedPair pair{config};
  const auto flag = static_cast<std::uint32_t>(ArmFlag::has_acceleration);
  double most = 0.0;
  for (int i = 0; i < 2'000; ++i) {
    pair.step();
    most = std::max(most, pair.master().tool_acceleration_m_per_s2.norm());
  }
  EXPECT_NE(pair.master().arm_flags & flag, 0U);
  EXPECT_EQ(pair.slave().arm_flags & flag, 0U);
  EXPECT_GT(most, 0.5) << "the hand reaches";
  EXPECT_EQ(pair.slave().tool_acceleration_m_per_s2, Vector3{Vector3::Zero()});
}

TEST(Pair, RecordsWhatEachVelocityEstimatorMakesOfTheRecordedReadings) {
  for (const std::string_view kind : velocity_kinds()) {
    SimulatedPair::Config config = pair_with("reach");
    config.station.velocity.kind = kind;
    config.station.law = {.stiffness_master_N_per_m = 20.0,
                          .stiffness_slave_N_per_m = 20.0,
                          .damping_master_Ns_per_m = 0.0,
                          .damping_slave_Ns_per_m = 0.0};
    SimulatedPair pair{config};
    VelocityEstimator replayed{config.station.velocity, pair.master_arm().info().counts_per_rev};
    double most = 0.0;
    for (int i = 0; i < 1'500; ++i) {
      pair.step();
      const TickRecord& r = pair.master();
      const JointVector qd =
          replayed.step({.q = r.q_rad, .period_ticks = r.period_ticks, .dt = 1e-3 * r.elapsed_ms});
      ASSERT_NEAR((qd - r.qd_rad_per_s).norm(), 0.0, 1e-9) << kind << ' ' << i;
      most = std::max(most, qd.norm());
    }
    EXPECT_GT(most, 0.1) << kind << ": the hand hardly moved";
  }
}

TEST(Pair, GivesTheSameBitsTwice) {
  std::vector<TickRecord> first;
  for (int run = 0; run < 2; ++run) {
    SimulatedPair pair{pair_with("reach", "soft")};
    for (int i = 0; i < 3'000; ++i) {
      pair.step();
      if (run == 0) {
        first.push_back(pair.slave());
        continue;
      }
      for_each_field(pair.slave(), [&](const Field& field, const auto& value) {
        for_each_field(first[static_cast<std::size_t>(i)],
                       [&](const Field& other, const auto& expected) {
                         if constexpr (std::is_same_v<decltype(value), decltype(expected)>) {
                           if (field.number == other.number) {
                             ASSERT_EQ(std::memcmp(&value, &expected, sizeof value), 0)
                                 << field.name << " in turn " << i;
                           }
                         }
                       });
      });
    }
  }
}

TEST(Pair, LetsGoWithin20MillisecondsOfSilenceAndComesBackWithoutAJump) {
  SimulatedPair pair{pair_with("reach")};
  const Observed before = observe(pair, 2'000);
  ASSERT_EQ(pair.master().mode, static_cast<std::uint32_t>(Mode::engaged));

  pair.network().outage(true);
  for (int i = 0; i < 20; ++i)
    pair.step();
  EXPECT_EQ(pair.master().mode, static_cast<std::uint32_t>(Mode::holding));
  EXPECT_EQ(pair.master().coupling_N, Vector3::Zero());
  EXPECT_EQ(pair.slave().coupling_N, Vector3::Zero());
  for (int i = 0; i < 500; ++i)
    pair.step();

  pair.network().outage(false);
  const Observed after = observe(pair, 2'000);
  EXPECT_GT(after.engaged_turns, 1'500);
  EXPECT_LT(after.largest_force_step_N, 1.5 * before.largest_force_step_N)
      << "a step beyond those that encoder counts make all the time";
}

TEST(Pair, StopsOnlyTheArmThatHasAFaultAndHoldsTheOther) {
  SimulatedPair::Config config = pair_with("reach");
  config.slave.faults.push_back({.kind = SimulatedArm::FaultKind::nan_angle,
                                 .at = std::chrono::milliseconds{1500},
                                 .axis = 1});
  SimulatedPair pair{config};

  (void)observe(pair, 1'600);

  EXPECT_EQ(pair.slave().mode, static_cast<std::uint32_t>(Mode::faulted));
  EXPECT_EQ(pair.slave().fault, static_cast<std::uint32_t>(Fault::state_not_finite));
  EXPECT_EQ(pair.slave().tau_Nm, JointVector::Zero());
  EXPECT_EQ(pair.master().mode, static_cast<std::uint32_t>(Mode::holding));
  EXPECT_TRUE(pair.master().tau_Nm.allFinite());
}

TEST(Pair, FollowsByComputedTorqueToo) {
  SimulatedPair::Config config = pair_with("reach");
  config.station.computed_torque = true;
  SimulatedPair pair{config};

  const Observed seen = observe(pair, 6'000);

  EXPECT_GT(seen.engaged_turns, 5'500);
  EXPECT_LT(seen.tracking_rms_mm, 5.0);
}

TEST(Pair, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  SimulatedPair pair{pair_with("press", "wall")};

  const testing::NoAllocation guard;
  for (int i = 0; i < 2'000; ++i)
    pair.step();
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
