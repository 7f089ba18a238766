#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/identification/planted_arm.hpp"
#include "tests/identification/tally.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::measure;
using testing::planted_forms;
using testing::PlantedArm;
using testing::Tally;

TEST(PlantedResponse, MassesSpringsAndDampersAreFoundBehindRoundingAndNoise) {
  const Tally tally = planted_forms(310, 10);

  EXPECT_EQ(tally.masses_and_springs_off, 0);
  EXPECT_EQ(tally.dampers_off, 0);
  EXPECT_GE(tally.covered, 0.75 * tally.estimates);  // of 45: the campaign has the sharp bounds
}

TEST(PlantedResponse, CoulombFrictionIsFlaggedAndBendsNothingByMoreThanFivePercent) {
  Eigen::VectorXd bias = Eigen::VectorXd::Zero(4);
  constexpr std::uint64_t kArms = 6;
  for (std::uint64_t i = 0; i < kArms; ++i) {
    const PlantedArm planted{520 + 2 * i, 0.04};
    const ResponseMeasurement measurement = measure(planted, {.seed = i});
    ASSERT_TRUE(measurement.response.has_value()) << i;
    EXPECT_TRUE(measurement.response->distorted) << i << ": " << measurement.response->distortion;
    EXPECT_GT(measurement.response->lines.front().odd, measurement.response->lines.front().even);
    const MechanicalFit fit =
        fit_mechanical(planted.form, measured(*measurement.response), {.period_s = 1e-4});
    EXPECT_TRUE(fit.family.has_ground_damper) << i;
    const Eigen::VectorXd truth = planted.true_values();
    for (Eigen::Index k = 0; k < 4; ++k) {
      bias(k) += (fit.estimates.at(static_cast<std::size_t>(k)).value / truth(k) - 1.0) / kArms;
    }
  }
  EXPECT_LE(bias.cwiseAbs().maxCoeff(), 0.05) << bias.transpose();
}

TEST(MeasureResponse, StatesTheErrorsOfItsLinesEvenWhereRoundingRepeatsEveryPeriod) {
  PlantedArm planted{612};
  planted.config.quantum_m = 45e-6;
  planted.config.noise_std_m = 1e-7;  // no dither: all periods are rounded alike
  const ResponseMeasurement measurement = measure(planted, {});
  ASSERT_TRUE(measurement.response.has_value());
  const MechanicalFamily family{.form = planted.form};
  Linearised system = family(family.pack(planted.truth));
  system.derivatives.clear();
  const MeasuredResponse data = measured(*measurement.response);
  const ComplexResponse truth = sampled_response(system, {.period_s = 1e-4}, data.frequency_Hz);
  const double ratio =
      ((data.value - truth.value).cwiseAbs().array() / data.deviation.array()).square().mean();
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.4);
}

TEST(MeasureResponse, OfASteppedSineIsThatOfTheMechanism) {
  const PlantedArm planted{613};
  const ResponseMeasurement measurement =
      measure(planted, {.excitation = Excitation::stepped_sine, .lines = 20});
  ASSERT_TRUE(measurement.response.has_value());
  EXPECT_FALSE(measurement.response->distorted) << measurement.response->distortion;
  const MechanicalFamily family{.form = planted.form};
  Linearised system = family(family.pack(planted.truth));
  system.derivatives.clear();
  const MeasuredResponse data = measured(*measurement.response);
  const ComplexResponse truth = sampled_response(system, {.period_s = 1e-4}, data.frequency_Hz);
  for (Eigen::Index i = 0; i < data.value.size(); ++i) {
    EXPECT_LE(std::abs(data.value(i) - truth.value(i)),
              4.0 * data.deviation(i) + 2e-3 * std::abs(truth.value(i)))
        << data.frequency_Hz(i) << " Hz";
  }
}

TEST(MeasureResponse, OfTheSameSeedIsTheSameToTheBit) {
  const PlantedArm planted{7};
  const ResponseExperiment quick{.rate_Hz = 2000.0, .realisations = 3};
  const auto first = measure(planted, quick);
  const auto second = measure(planted, quick);
  ASSERT_TRUE(first.response && second.response);
  for (std::size_t i = 0; i < first.response->lines.size(); ++i) {
    EXPECT_EQ(first.response->lines[i].gain, second.response->lines[i].gain);
    EXPECT_EQ(first.response->lines[i].deviation, second.response->lines[i].deviation);
  }
}

TEST(MeasureResponse, StaysWithinForceAndTravel) {
  for (std::uint64_t seed = 40; seed < 44; ++seed) {
    const ResponseExperiment small{.rate_Hz = 2000.0,
                                   .realisations = 3,
                                   .max_force_N = 1.0,
                                   .max_travel_m = 0.002,
                                   .seed = seed};
    const ResponseMeasurement measurement = measure(PlantedArm{seed}, small);
    EXPECT_TRUE(measurement.response.has_value()) << seed;
    for (const PeriodicDrive::Outcome& drive : measurement.drives) {
      EXPECT_LE(drive.largest_force_N, 1.0 + 1e-12);
      EXPECT_LE(drive.largest_travel_m, 0.002);
      EXPECT_TRUE(drive.at_rest);
    }
  }
}

TEST(MeasureResponse, RefusesWhatCannotBeMeasured) {
  const auto refused = [](const ResponseExperiment& experiment) {
    EXPECT_THROW(check(experiment), ConfigError);
  };
  refused({.rate_Hz = 20000.0});
  refused({.rate_Hz = 1000.0, .high_Hz = 500.0});
  refused({.low_Hz = 1.0});
  refused({.low_Hz = 100.0, .high_Hz = 120.0});
  refused({.realisations = 2});
  refused({.max_force_N = 0.0});
  EXPECT_NO_THROW(check({}));
}

/// A drive of a constant push, which no weak loop holds within its travel.
struct Push {
  SimulatedClock clock;
  LinearArm arm{{}, clock};
  ArmModel model = load_arm("phantom-1.5");
  std::atomic<bool> stop{false};
  PeriodicDrive drive;

  explicit Push(double force_N)
      : drive{{.rate_Hz = 1000.0},
              model,
              {{.reference_N = Eigen::VectorXd::Constant(1000, force_N),
                .settle_periods = 1,
                .periods = 2}},
              stop} {}

  void run(std::optional<std::uint64_t> stop_at = {}) {
    run_periodically(clock, std::chrono::milliseconds{1}, [&](const Tick& tick) noexcept {
      if (stop_at && tick.index == *stop_at) stop = true;
      return drive.step(arm, tick);
    });
  }
};

TEST(PeriodicDrive, BrakesBeyondItsTravelAndEndsAtRestWithoutTorque) {
  Push push{1.0};
  push.run();
  EXPECT_EQ(push.drive.outcome().end, DriveEnd::travel);
  EXPECT_TRUE(push.drive.outcome().at_rest);
  EXPECT_LT(push.drive.outcome().largest_travel_m, 0.0075);
  EXPECT_EQ(push.arm.true_state().force.norm(), 0.0);
  EXPECT_FALSE(push.arm.read().has(ArmFlag::amplifiers_on));
}

TEST(PeriodicDrive, EndsAtRestWhenInterrupted) {
  Push push{0.01};
  push.run(2500);
  EXPECT_EQ(push.drive.outcome().end, DriveEnd::interrupted);
  EXPECT_TRUE(push.drive.outcome().at_rest);
  EXPECT_EQ(push.arm.true_state().force.norm(), 0.0);
}

TEST(PeriodicDrive, LeavesOutPeriodsThatLostSamples) {
  Push push{0.01};
  Tick tick{.elapsed = std::chrono::milliseconds{1}};
  while (push.drive.step(push.arm, tick) == Next::again) {
    const bool late = tick.index == 2700;  // in the first period that is kept
    const Duration step = std::chrono::milliseconds{late ? 4 : 1};
    push.clock.sleep_until(push.clock.now() + step);
    tick = {.index = tick.index + 1, .elapsed = step, .missed = tick.missed + (late ? 3U : 0U)};
  }
  EXPECT_EQ(push.drive.outcome().end, DriveEnd::done);
  EXPECT_EQ(push.drive.outcome().missed, 3U);
  EXPECT_EQ(push.drive.records().front().force_N.cols(), 0);  // and the one after hears the echo
}

TEST(PeriodicDrive, StepDoesNotAllocate) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "sanitizers own malloc";
  Push push{0.01};
  const testing::NoAllocation guard;
  push.run();
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(push.drive.outcome().end, DriveEnd::done);
}

}  // namespace
}  // namespace teleop
