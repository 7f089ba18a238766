/// Shipped gains are half of the marginal gain that the tuner finds at the worst pose. Here at that
/// pose; the campaign looks for a worse one.

#include "tests/tuner/shipped_gains.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/control/position_error.hpp"
#include "core/device/device.hpp"
#include "core/model/arm_model.hpp"
#include "core/tuning/pose_move.hpp"
#include "core/tuning/tune_point.hpp"

namespace teleop {
namespace {

using testing::shipped_pair;
using testing::WorstPose;

/// Two shipped arms taken to the worst pose and tuned there, the peer's motion so many samples old.
PointResult tune_at_worst_pose(int peer_delay_samples) {
  const WorstPose worst;
  const TuneOptions options = shipped_pair();
  SimulatedClock clock;
  ProbeRunner::Ports ports{.clock = &clock, .time_waits = true};
  std::vector<std::unique_ptr<Arm>> arms;
  std::vector<ToolFrame> frames;
  std::vector<MovedArm> moved;
  const ArmModel model = load_arm("phantom-1.5");
  for (const std::uint64_t seed : {1U, 2U}) {
    arms.push_back(open_device("sim", {.clock = clock, .seed = seed}));
    Arm& arm = *arms.back();
    ports.arms.push_back(&arm);
    frames.push_back(frame_at(model, arm.info(), worst.q));
    moved.push_back({.arm = &arm, .model = &model});
  }
  move_to(moved, clock, worst.q, {});
  PointConfig config;
  config.experiment = {.experiment = GainExperiment::teleop,
                       .axis = worst.axis,
                       .damping_Ns_per_m = options.damping_Ns_per_m,
                       .peer_delay_samples = peer_delay_samples};
  config.search.width = 0.01 * options.width_percent;
  return tune_point(config, frames, ports);
}

TEST(ShippedGains, AreHalfOfWhatTheTunerFindsAtTheWorstPose) {
  const PositionError::Config shipped{};
  const PointResult point = tune_at_worst_pose(1);
  ASSERT_EQ(point.end, SearchEnd::found);
  ASSERT_TRUE(point.crossing);
  const double gain = point.crossing.value_or(Crossing{}).gain;
  RecordProperty("marginal_N_per_m", std::to_string(gain));
  EXPECT_NEAR(0.5 * gain / shipped.stiffness_slave_N_per_m, 1.0, 0.03) << gain;
  EXPECT_LE(shipped.stiffness_slave_N_per_m, 0.5 * WorstPose{}.gain_N_per_m);
  EXPECT_EQ(shipped.stiffness_master_N_per_m, shipped.stiffness_slave_N_per_m);
  EXPECT_EQ(shipped.damping_master_Ns_per_m, shipped.damping_slave_Ns_per_m);
}

TEST(ShippedGains, BearAPeerThreeSamplesOldAtTheWorstPose) {
  const PointResult point = tune_at_worst_pose(3);
  ASSERT_TRUE(point.crossing);
  EXPECT_GT(point.crossing.value_or(Crossing{}).low,
            PositionError::Config{}.stiffness_slave_N_per_m);
}

}  // namespace
}  // namespace teleop
