#include "scenarios/concealed/judge.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "scenarios/concealed/device_draw.hpp"
#include "scenarios/concealed/size_search.hpp"
#include "tests/concealed/loops.hpp"

namespace teleop::concealed {
namespace {

using testing::on;
using testing::phantom;

/// Error covariance of a linear filter run on its own model, by simulation: the gain that a Riccati
/// recursion finds may not be beaten by its neighbours.
double innovation_rms(const TetherGain& gain, const AxisNoise& noise, double inertia) {
  Random random{17};
  double q = 0.0;
  double v = 0.0;
  double d = 0.0;
  double seen_q = 0.0;
  double seen_v = 0.0;
  double seen_d = 0.0;
  double sum = 0.0;
  constexpr int kSteps = 200000;
  constexpr double kT = 1e-3;
  for (int k = 0; k < kSteps; ++k) {
    const double e = q + noise.reading_rad * random.normal() - seen_q;
    sum += e * e;
    seen_q += gain.q * e;
    seen_v += gain.v * e;
    seen_d += gain.d * e;
    const double push = kT * (d + noise.white_Nm * random.normal()) / inertia;
    const double seen_push = kT * seen_d / inertia;
    q += kT * (v + push / 2.0);
    v += push;
    seen_q += kT * (seen_v + seen_push / 2.0);
    seen_v += seen_push;
    d = gain.forgotten * d +
        noise.coloured_Nm * std::sqrt(1.0 - gain.forgotten * gain.forgotten) * random.normal();
    seen_d *= gain.forgotten;
  }
  return std::sqrt(sum / kSteps);
}

TEST(Tether, HasTheGainThatLeavesTheSmallestInnovations) {
  const AxisNoise noise{
      .white_Nm = 5e-4, .coloured_Nm = 7e-4, .coloured_time_s = 0.03, .reading_rad = 3.6e-5};
  const TetherGain best = tether_gain(1e-3, noise, 1e-3);
  const double rms = innovation_rms(best, noise, 1e-3);
  EXPECT_GT(rms, noise.reading_rad);
  for (const double factor : {0.7, 1.4}) {
    for (double TetherGain::* const member : {&TetherGain::q, &TetherGain::v, &TetherGain::d}) {
      TetherGain other = best;
      other.*member *= factor;
      EXPECT_GT(innovation_rms(other, noise, 1e-3), rms);
    }
  }
}

TEST(Judge, SeesLargerEffectsBetterAndNothingWhereNothingIs) {
  Random random{5};
  Device device = draw_device(phantom(), {}, random);
  const auto judged = [&](double level) {
    device.effects = {on(1, "coulomb_friction", {{"level", level}, {"asymmetry", 0.0}})};
    const auto run = simulate(device, 1, 40);
    return detectability(device, std::vector<JudgedRun>{{1, &run}}, 8);
  };
  const double small = judged(1e-3);
  const double large = judged(4e-3);
  EXPECT_NEAR(judged(0.0), 0.0, 1e-3);
  EXPECT_GT(small, 0.005);
  EXPECT_GT(large, 2.0 * small);
}

TEST(Judge, IsHardlyMovedByItsStep) {
  Random random{6};
  Device device = draw_device(phantom(), {}, random);
  device.effects = {on(2, "stribeck_friction",
                       {{"coulomb", 1e-3}, {"static", 2e-3}, {"stribeck_velocity", 0.05}})};
  const auto run = simulate(device, 2, 40);
  const std::vector<JudgedRun> list{{2, &run}};
  const double coarse = detectability(device, list, 8);
  EXPECT_NEAR(coarse, detectability(device, list, 40), 0.02 * coarse + 1e-3);
}

TEST(SizeSearch, FindsTheSizeOfAWantedDetectability) {
  Random random{77};
  const Device device = draw_device(phantom(), {}, random);
  for (const char* kind : {"torque_deadzone", "sensor_delay"}) {
    const Sized effect{kind, 2, phantom(), random};
    for (const double target : {0.01, 0.05, 0.4}) {
      const Found found = search_size(device, effect, target);
      EXPECT_NEAR(std::log(found.detectability / target), 0.0, std::log(1.25)) << kind;
    }
  }
}

}  // namespace
}  // namespace teleop::concealed
