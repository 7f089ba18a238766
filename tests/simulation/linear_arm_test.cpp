#include "core/simulation/linear_arm.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/matrix_exponential.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only

Duration from_seconds(double s) {
  return Duration{static_cast<std::int64_t>(std::llround(s * 1e9))};
}

/// Lets an axis live across the switches of its queue.
void live(LinearAxis& axis, Duration span) {
  while (span > Duration{0}) {
    const Duration piece = std::min(span, axis.until_switch());
    axis.advance(piece);
    span -= piece;
  }
}

TEST(MatrixExponential, TurnsByTheAngleOfASkewMatrix) {
  for (const double angle : {1e-3, 1.0, 40.0}) {
    const Eigen::Matrix2d A{{0.0, -angle}, {angle, 0.0}};
    const Eigen::Matrix2d turn{{std::cos(angle), -std::sin(angle)},
                               {std::sin(angle), std::cos(angle)}};
    EXPECT_LT((matrix_exponential(A) - turn).norm(), 1e-13) << angle;
  }
}

TEST(MatrixExponential, IsExactForNilpotentMatrices) {
  const Eigen::Matrix3d A{{0.0, 2.0, 3.0}, {0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}};
  const Eigen::Matrix3d exact{{1.0, 2.0, 7.0}, {0.0, 1.0, 4.0}, {0.0, 0.0, 1.0}};
  EXPECT_LT((matrix_exponential(A) - exact).norm(), 1e-14);
}

TEST(LinearAxis, FollowsTheClosedFormOfADelayedStepThroughALag) {
  constexpr double kDelay = 1.37e-3;
  constexpr double kLag = 0.6e-3;
  LinearAxis axis{{.mass_kg = 0.05, .damping_Ns_per_m = 0.0, .delay_s = kDelay, .lag_s = kLag}};
  axis.command(2.0);
  for (int i = 1; i <= 40; ++i) {
    live(axis, 250us);
    const double t = std::max(i * 250e-6 - kDelay, 0.0);
    const double rise = 1.0 - std::exp(-t / kLag);
    const double v = 2.0 / 0.05 * (t - kLag * rise);
    const double x = 2.0 / 0.05 * (0.5 * t * t - kLag * t + kLag * kLag * rise);
    EXPECT_NEAR(axis.force(), 2.0 * rise, 1e-12);
    EXPECT_NEAR(axis.velocity(), v, 1e-12);
    EXPECT_NEAR(axis.position(), x, 1e-14);
  }
}

TEST(LinearAxis, LandsAtTheSamePlaceWhateverTheInstantsBetween) {
  const LinearAxis::Config config{.mass_kg = 0.02,
                                  .damping_Ns_per_m = 0.4,
                                  .delay_s = 2.9e-3,
                                  .lag_s = 1e-3,
                                  .second_mass_kg = 0.04,
                                  .joint_N_per_m = 3000.0,
                                  .joint_damping_Ns_per_m = 0.3};
  LinearAxis once{config};
  LinearAxis often{config};
  Random random{5};
  for (int k = 0; k < 200; ++k) {
    const double u = random.uniform(-2.0, 2.0);
    once.command(u);
    often.command(u);
    live(once, 1ms);
    Duration left = 1ms;
    while (left > Duration{0}) {
      const Duration piece = std::min(left, from_seconds(random.uniform(1e-6, 4e-4)));
      live(often, piece);
      left -= piece;
    }
    EXPECT_NEAR(once.position(), often.position(), 1e-12);
    EXPECT_NEAR(once.velocity(), often.velocity(), 1e-10);
  }
  EXPECT_GT(std::abs(once.position()), 1e-5);
}

TEST(LinearAxis, TwoMassesKeepTheirMomentumAndRingAtTheirResonance) {
  const double m1 = 0.0154;
  const double m2 = 0.0619;
  const double k = 5690.0;
  LinearAxis axis{
      {.mass_kg = m1, .damping_Ns_per_m = 0.0, .second_mass_kg = m2, .joint_N_per_m = k}};
  axis.command(1.0);
  live(axis, 1ms);
  axis.command(0.0);
  const double momentum = 1e-3;
  const double w = std::sqrt(k * (m1 + m2) / (m1 * m2));
  double v_at_crossing = 0.0;
  double last = axis.velocity() - momentum / (m1 + m2);
  int crossings = 0;
  Duration t{0};
  Duration first{0};
  while (crossings < 21) {
    live(axis, 10us);
    t += 10us;
    const double v = axis.velocity() - momentum / (m1 + m2);
    if (v * last < 0.0) {
      if (++crossings == 1) first = t;
      v_at_crossing = v;
    }
    last = v;
  }
  EXPECT_LT(std::abs(v_at_crossing), 1e-2);
  EXPECT_NEAR(seconds(t - first) / (20.0 * std::numbers::pi / w), 1.0, 1e-3);
}

TEST(LinearAxis, ReadsTheTendonStretchedByTheForce) {
  LinearAxis axis{{.tendon_N_per_m = 5000.0}};
  axis.command(2.0);
  EXPECT_NEAR(axis.reading() - axis.position(), 2.0 / 5000.0, 1e-15);
}

TEST(LinearAxis, NeitherGainsEnergyNorMovesAgainstFrictionThatHoldsIt) {
  LinearAxis axis{{.mass_kg = 0.05, .damping_Ns_per_m = 0.0, .coulomb_N = 0.04}};
  axis.command(0.039);
  live(axis, 100ms);
  EXPECT_EQ(axis.position(), 0.0);
  axis.command(0.14);
  live(axis, 50ms);
  const double v = 0.1 / 0.05 * 0.05;
  EXPECT_NEAR(axis.velocity(), v, 1e-9);
  axis.command(0.0);
  live(axis, 500ms);
  EXPECT_EQ(axis.velocity(), 0.0);
  // Δx of the push, then v² m / (2 F) of the slide to rest.
  EXPECT_NEAR(axis.position(), 0.5 * v * 0.05 + v * v * 0.05 / (2.0 * 0.04), 1e-9);
}

TEST(LinearAxis, IsRefusedUnlessItIsPassive) {
  EXPECT_THROW(LinearAxis{{.mass_kg = 0.0}}, ConfigError);
  EXPECT_THROW(LinearAxis{{.damping_Ns_per_m = -1.0}}, ConfigError);
  EXPECT_THROW(LinearAxis{{.joint_N_per_m = 100.0}}, ConfigError);
  EXPECT_THROW(LinearAxis{{.delay_s = 0.1}}, ConfigError);
}

TEST(LinearArm, MapsJointsToToolAxesAndReadsWholeQuanta) {
  SimulatedClock clock;
  const double quantum = 40e-6;
  LinearArm arm{
      {.axes = {LinearAxis::Config{.mass_kg = 0.02}, {.mass_kg = 0.04}, {.mass_kg = 0.08}},
       .quantum_m = quantum},
      clock};
  arm.amplifiers(true);
  const JointVector r = LinearArm::lever_m();
  for (int k = 0; k < 50; ++k) {
    const ArmState state = arm.read();
    const Vector3 x = arm.true_state().position;
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_NEAR(state.q[i] * r[i] / quantum, std::round(x[i] / quantum), 1e-6);
    }
    EXPECT_TRUE(state.has(ArmFlag::has_period));
    arm.write(r.cwiseProduct(JointVector::Constant(0.5)));
    clock.sleep_until(clock.now() + 1ms);
  }
  const Vector3 x = arm.true_state().position;
  EXPECT_GT(x[0], x[1]);
  EXPECT_GT(x[1], x[2]);
  EXPECT_GT(x[2], 1e-3);
}

TEST(LinearArm, GivesNoForceWhileItsAmplifiersAreOff) {
  SimulatedClock clock;
  LinearArm arm{{}, clock};
  arm.write(JointVector::Constant(0.1));
  clock.sleep_until(clock.now() + 20ms);
  EXPECT_EQ(arm.read().q, JointVector::Zero());
  EXPECT_EQ(arm.true_state().velocity, Vector3::Zero());
}

TEST(LinearArm, NoiseHasTheDeviationThatWasAskedAndTheSeedRepeatsIt) {
  const auto trace = [](std::uint64_t seed) {
    SimulatedClock clock;
    LinearArm arm{{.quantum_m = 1e-7, .noise_std_m = 5e-6, .seed = seed}, clock};
    std::vector<double> x;
    for (int k = 0; k < 4000; ++k) {
      x.push_back(arm.read().q[0] * LinearArm::lever_m()[0]);
      clock.sleep_until(clock.now() + 1ms);
    }
    return x;
  };
  const auto x = trace(3);
  double sum = 0.0;
  for (const double value : x)
    sum += value * value;
  EXPECT_NEAR(std::sqrt(sum / 4000.0), 5e-6, 0.3e-6);
  EXPECT_EQ(x, trace(3));
  EXPECT_NE(x, trace(4));
}

TEST(LinearArm, ReadsAndWritesWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "the sanitizer owns malloc";
  SimulatedClock clock;
  const LinearAxis::Config axis{.delay_s = 1.5e-3, .lag_s = 1e-3, .coulomb_N = 0.04};
  LinearArm arm{{.axes = {axis, axis, axis}, .noise_std_m = 1e-6}, clock};
  arm.amplifiers(true);
  const testing::NoAllocation guard;
  for (int k = 0; k < 300; ++k) {
    (void)arm.read();
    arm.write(JointVector::Constant(0.1 * std::sin(0.1 * k)));
    clock.sleep_until(clock.now() + 1ms);
  }
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
