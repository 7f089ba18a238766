#include "core/tuning/tune_point.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/simulation/linear_arm.hpp"
#include "core/tuning/analytic_margin.hpp"

namespace teleop {
namespace {

struct Found {
  PointResult point;
  double analytic = 0.0;
};

struct How {
  GainExperiment experiment = GainExperiment::wall;
  std::vector<LinearAxis::Config> axes{};
  int mean_samples = 0;  ///< of the mean estimator; 0: the default one
  bool time_waits = true;
  double hold_N_per_m = 10.0;
  std::vector<ProbeResult> history{};
};

Found tune(const How& how) {
  VelocityEstimator::Config velocity;
  if (how.mean_samples > 0) {
    velocity.kind = "mean";
    velocity.mean.samples = how.mean_samples;
  }
  SimulatedClock clock;
  std::vector<std::unique_ptr<LinearArm>> arms;
  ProbeRunner::Ports ports{.clock = &clock, .time_waits = how.time_waits};
  std::vector<ToolFrame> frames;
  for (const LinearAxis::Config& axis : how.axes) {
    LinearArm::Config config{.quantum_m = 25e-6};
    config.axes[0] = axis;
    arms.push_back(std::make_unique<LinearArm>(config, clock));
    ports.arms.push_back(arms.back().get());
    frames.push_back({.J = LinearArm::lever_m().asDiagonal(),
                      .counts_per_rev = arms.back()->info().counts_per_rev});
  }
  PointConfig config;
  config.search.most_arm_seconds = 1e9;  // time runs fast while it thinks
  config.experiment = {.experiment = how.experiment,
                       .axis = 0,
                       .velocity = velocity,
                       .hold_stiffness_N_per_m = how.hold_N_per_m,
                       .hold_damping_Ns_per_m = 0.5};
  const bool damps = how.experiment == GainExperiment::damping;
  const auto margin = nyquist_margin({.arms = how.axes, .velocity = velocity},
                                     damps ? TunedGain::damping : TunedGain::stiffness);
  return {.point = tune_point(config, frames, ports, how.history), .analytic = margin->gain};
}

const LinearAxis::Config kLight{.mass_kg = 0.04, .damping_Ns_per_m = 1.5, .delay_s = 1.3e-3};
const LinearAxis::Config kHeavy{.mass_kg = 0.12, .damping_Ns_per_m = 1.0, .lag_s = 0.5e-3};
const LinearAxis::Config kFlexible{.mass_kg = 0.03,
                                   .damping_Ns_per_m = 2.0,
                                   .delay_s = 0.4e-3,
                                   .second_mass_kg = 0.03,
                                   .joint_N_per_m = 4000.0,
                                   .joint_damping_Ns_per_m = 0.8};

void expect_found(const Found& found) {
  ASSERT_EQ(found.point.end, SearchEnd::found);
  ASSERT_TRUE(found.point.crossing);
  EXPECT_NEAR(found.point.crossing->gain / found.analytic, 1.0, 0.01);
  EXPECT_LE(found.point.crossing->relative_width(), 0.01);
  for (const ProbeResult& probe : found.point.probes)
    EXPECT_TRUE(probe.outcome.rests);
}

TEST(TunePoint, FindsTheMarginOfAWall) { expect_found(tune({.axes = {kLight}})); }

TEST(TunePoint, FindsTheMarginWhereAStructuralModeSetsIt) {
  expect_found(tune({.axes = {kFlexible}}));
}

TEST(TunePoint, FindsTheMarginOfADamper) {
  expect_found(tune({.experiment = GainExperiment::damping, .axes = {kHeavy}, .mean_samples = 30}));
}

TEST(TunePoint, FindsTheMarginOfAPairAndWhichSideMovesMost) {
  const Found found = tune({.experiment = GainExperiment::teleop, .axes = {kHeavy, kLight}});
  expect_found(found);
  double master = 0.0;
  double slave = 0.0;
  for (const ShapeEntry& entry : found.point.shape) {
    if (entry.axis != 0) {
      EXPECT_LT(entry.ratio, 0.05);
      continue;
    }
    (entry.arm == 0 ? master : slave) = entry.ratio;
  }
  EXPECT_EQ(slave, 1.0);
  EXPECT_NEAR(master, 0.04 / 0.12, 0.1);
}

TEST(TunePoint, GivesTheSameAnswerAgain) {
  const Found one = tune({.axes = {kLight}});
  const Found two = tune({.axes = {kLight}});
  EXPECT_EQ(one.point.crossing->gain, two.point.crossing->gain);
  EXPECT_EQ(one.point.probes.size(), two.point.probes.size());
}

TEST(TunePoint, GoesOnFromWhatWasDoneAndRepeatsNothing) {
  const Found whole = tune({.axes = {kLight}});
  for (const std::size_t done : {std::size_t{3}, whole.point.probes.size() - 2}) {
    std::vector<ProbeResult> history = whole.point.probes;
    history.resize(done);
    const Found rest = tune({.axes = {kLight}, .history = history});
    expect_found(rest);
    for (std::size_t i = 0; i < done; ++i)
      EXPECT_EQ(rest.point.probes[i].plan.gain, whole.point.probes[i].plan.gain);
    EXPECT_EQ(rest.point.probes[done].plan.gain, whole.point.probes[done].plan.gain);
  }
}

TEST(TunePoint, FindsTheSameWhereTimeGoesOnWhileItThinks) {
  expect_found(tune({.axes = {kLight}, .time_waits = false}));
}

/// Coulomb friction damps an oscillation of amplitude A as 4 F/(π A ω) would.
TEST(TunePoint, FindsTheGainThatHoldsAnOscillationOfAmplitudeAUnderFriction) {
  LinearAxis::Config axis = kHeavy;
  axis.coulomb_N = 0.03;
  // The weak loop has to bring the tool back against the friction.
  const Found found = tune({.axes = {axis}, .hold_N_per_m = 60.0});
  ASSERT_TRUE(found.point.crossing);
  const double A = found.point.amplitude_m;
  LinearAxis::Config equivalent = kHeavy;
  double frequency_Hz = found.point.frequency_Hz;
  double gain = 0.0;
  for (int i = 0; i < 5; ++i) {
    equivalent.damping_Ns_per_m =
        kHeavy.damping_Ns_per_m +
        4.0 * axis.coulomb_N / (std::numbers::pi * A * 2.0 * std::numbers::pi * frequency_Hz);
    const auto margin = nyquist_margin({.arms = {equivalent}}, TunedGain::stiffness);
    gain = margin->gain;
    frequency_Hz = margin->frequency_Hz;
  }
  EXPECT_GT(gain, 1.3 * found.analytic);
  EXPECT_NEAR(found.point.crossing->gain / gain, 1.0, 0.08);
}

TEST(TunePoint, StopsWhereItIsToldToWithTheArmAtRest) {
  SimulatedClock clock;
  LinearArm::Config plant{.quantum_m = 25e-6};
  plant.axes[0] = kLight;
  LinearArm arm{plant, clock};
  PointConfig config;
  config.experiment = {.experiment = GainExperiment::wall, .axis = 0};
  int probes = 0;
  config.on_probe = [&](const ProbeResult&) {
    ++probes;
  };
  config.stop_asked = [&] {
    return probes >= 4;
  };
  const PointResult result = tune_point(config,
                                        {ToolFrame{.J = LinearArm::lever_m().asDiagonal(),
                                                   .counts_per_rev = arm.info().counts_per_rev}},
                                        {.arms = {&arm}, .clock = &clock, .time_waits = true});
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.probes.size(), 4U);
  EXPECT_LT(arm.true_state().velocity.norm(), 3e-3);
}

}  // namespace
}  // namespace teleop
