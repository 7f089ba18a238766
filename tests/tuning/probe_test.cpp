#include "core/tuning/probe.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/simulation/linear_arm.hpp"
#include "core/tuning/probe_run.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

/// A wall on the y axis of a plant, probed through the port; every torque written is seen.
class SpiedArm final : public Arm {
 public:
  SpiedArm(const LinearArm::Config& config, Clock& clock) : arm{config, clock} {}
  [[nodiscard]] const ArmInfo& info() const noexcept override { return arm.info(); }
  [[nodiscard]] ArmState read() noexcept override {
    last = arm.read();
    const LinearArm::Truth truth = arm.true_state();
    speed = std::max(speed, std::abs(truth.velocity.y()));
    travel = std::max(travel, std::abs(truth.position.y()));
    return last;
  }
  void write(const JointVector& tau) noexcept override {
    force = tau.y() / LinearArm::lever_m().y();
    x = last.q.y() * LinearArm::lever_m().y();
    arm.write(tau);
  }
  void amplifiers(bool on) noexcept override { arm.amplifiers(on); }

  LinearArm arm;
  ArmState last{};
  double force = 0.0;
  double x = 0.0;
  double speed = 0.0;
  double travel = 0.0;
};

struct Rig {
  explicit Rig(const LinearAxis::Config& axis, const ProbeBounds& bounds = {})
      : arm{{.axes = {LinearAxis::Config{}, axis, LinearAxis::Config{}}, .quantum_m = 20e-6},
            clock},
        loop{{.experiment = GainExperiment::wall,
              .axis = 1,
              .hold_stiffness_N_per_m = 10.0,
              .hold_damping_Ns_per_m = 0.5},
             {ToolFrame{.J = LinearArm::lever_m().asDiagonal(),
                        .counts_per_rev = arm.info().counts_per_rev}}},
        probe{{.bounds = bounds}, loop} {
    arm.amplifiers(true);
  }

  /// Whole probe, tick by tick.
  template <class Look>
  void run(const ProbePlan& plan, Look&& look) {
    probe.begin(plan);
    while (!probe.done()) {
      const ArmState state = arm.read();
      arm.write(probe.step({state}, 1e-3).torque_Nm[0]);
      look();
      clock.sleep_until(clock.now() + Duration{1'000'000});
    }
  }

  SimulatedClock clock;
  SpiedArm arm;
  LoopUnderTest loop;
  Probe probe;
};

constexpr LinearAxis::Config kAxis{.mass_kg = 0.05, .damping_Ns_per_m = 1.0, .delay_s = 1e-3};
// Marginal near b/(T/2 + delay) = 667 N/m.
constexpr ProbePlan kStable{
    .gain = 500.0, .safe_gain = 100.0, .push_N = 1.0, .push_ticks = 5, .ceiling_m = 3e-3};
constexpr ProbePlan kUnstable{
    .gain = 2000.0, .safe_gain = 100.0, .push_N = 0.6, .push_ticks = 5, .ceiling_m = 1e-3};

TEST(Probe, RingsAndRestsBelowTheMarginalGain) {
  Rig rig{kAxis};
  rig.run(kStable, [] {});
  const ProbeOutcome& outcome = rig.probe.outcome();
  EXPECT_TRUE(outcome.stop == ProbeStop::decayed || outcome.stop == ProbeStop::time);
  EXPECT_TRUE(outcome.rests);
  EXPECT_EQ(outcome.fallbacks, 0);
  EXPECT_GT(rig.probe.trace().size, 100U);
  EXPECT_LT(std::abs(rig.arm.arm.true_state().velocity.y()), 4e-3);
}

TEST(Probe, IsBackAtTheSafeGainWithinTwoTicksOfAMotionTooLarge) {
  Rig rig{kAxis};
  int ticks_unsafe = 0;
  bool passed = false;
  int ticks = 0;
  rig.run(kUnstable, [&] {
    ++ticks;
    if (ticks < 80) return;
    passed = passed || rig.probe.outcome().stop == ProbeStop::grew;
    // With the safe gain and the weak loop the force is far below what the tried gain asks for.
    const bool safe = std::abs(rig.arm.force) < 0.3 * std::abs(2000.0 * rig.arm.x) + 0.3;
    if (passed && !safe) ++ticks_unsafe;
  });
  EXPECT_TRUE(passed);
  EXPECT_LE(ticks_unsafe, 1);
  EXPECT_LE(rig.probe.outcome().ticks_to_safe, 2);
  EXPECT_TRUE(rig.probe.outcome().rests);
}

/// Plants at random, gains far beyond the margin, pushes of all sizes: the plant's own motion stays
/// within the bounds, whichever of them stops the probe, and the arm rests at the end.
TEST(Probe, StaysWithinItsBoundsWhateverThePlantAndThePush) {
  Random random{21};
  int stopped = 0;
  for (int i = 0; i < 60; ++i) {
    const LinearAxis::Config axis{.mass_kg = random.uniform(0.02, 0.12),
                                  .damping_Ns_per_m = random.uniform(0.5, 5.0),
                                  .delay_s = random.uniform(0.0, 2.9e-3),
                                  .lag_s = random.uniform(0.0, 1e-3)};
    const ProbeBounds bounds{.speed_m_per_s = 0.4, .force_N = 3.0, .travel_m = 0.02};
    Rig rig{axis, bounds};
    const double marginal = axis.damping_Ns_per_m / (0.5e-3 + axis.delay_s + axis.lag_s);
    double most_force = 0.0;
    rig.run({.gain = marginal * random.uniform(1.0, 2.5),
             .safe_gain = 0.2 * marginal,
             .push_N = random.uniform(0.1, 0.8),
             .push_ticks = 4,
             .ceiling_m = 0.1},
            [&] { most_force = std::max(most_force, std::abs(rig.arm.force)); });
    if (is_bound(rig.probe.outcome().stop)) ++stopped;
    EXPECT_LE(rig.arm.travel, bounds.travel_m) << i;
    EXPECT_LE(rig.arm.speed, bounds.speed_m_per_s) << i;
    EXPECT_LE(most_force, bounds.force_N + 1e-9) << i;
    EXPECT_TRUE(rig.probe.outcome().rests) << i;
  }
  EXPECT_GT(stopped, 20);
}

TEST(Probe, LeavesASafeGainThatIsNotSafe) {
  Rig rig{kAxis};
  ProbePlan plan = kUnstable;
  plan.safe_gain = 1500.0;
  rig.run(plan, [] {});
  EXPECT_TRUE(rig.probe.outcome().swelled);
  EXPECT_GT(rig.probe.outcome().fallbacks, 0);
  EXPECT_TRUE(rig.probe.outcome().rests);
}

TEST(Probe, EndsAtOnceWithoutTorqueOnADeviceFault) {
  Rig rig{kAxis};
  rig.probe.begin(kStable);
  ArmState state = rig.arm.read();
  state.fault = Fault::device_unplugged;
  const LoopUnderTest::Turn turn = rig.probe.step({state}, 1e-3);
  EXPECT_TRUE(rig.probe.done());
  EXPECT_EQ(rig.probe.outcome().stop, ProbeStop::fault);
  EXPECT_EQ(turn.torque_Nm[0], JointVector::Zero());
}

TEST(Probe, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "the sanitizer owns malloc";
  Rig rig{kAxis};
  const testing::NoAllocation guard;
  rig.run(kStable, [] {});
  rig.run(kUnstable, [] {});
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
