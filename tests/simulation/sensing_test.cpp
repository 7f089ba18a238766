#include "core/simulation/sensing.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/effects/vocabulary.hpp"
#include "core/simulation/plant.hpp"
#include "tests/simulation/plants.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::phantom;

const JointVector kCounts{54476.8, 45875.2, 45875.2};

EffectSpec on(std::size_t axis, const char* kind, const std::map<std::string, double>& values) {
  return {.kind = kind, .axis = axis, .parameters = values};
}

TEST(Sensing, ReadsWhereTheDriveWasAFractionalDelayAgo) {
  const std::vector effects{on(0, "sensor_delay", {{"delay", 0.0017}}),
                            on(1, "sensor_delay", {{"delay", 0.003}})};
  const PlantTerms terms = terms_of(effects);
  Plant late{phantom(), {.terms = terms}};
  Plant early{phantom(), {.terms = terms}};
  Sensing sensing{terms.sensing, kCounts, JointVector::Zero()};
  const auto push = [](int tick) {
    return JointVector{0.03 * std::sin(0.01 * tick), 0.02 * std::cos(0.02 * tick), 0.0};
  };
  std::vector<double> first;
  std::vector<double> second;
  for (int tick = 0; tick < 300; ++tick) {
    early.set_torque(push(tick));
    early.advance(300us);
    first.push_back(early.q()[0]);  // 300 us after each whole millisecond
    early.advance(700us);
    second.push_back(early.q()[1]);
    late.set_torque(push(tick));
    late.advance(1ms, &sensing);
    if (tick < 3) continue;
    const auto k = static_cast<std::size_t>(tick);
    EXPECT_NEAR(sensing.exact_angles()[0], first[k - 1], 1e-10) << tick;
    EXPECT_NEAR(sensing.exact_angles()[1], second[k - 3], 1e-10) << tick;
    EXPECT_NEAR(sensing.exact_angles()[2], late.q()[2], 1e-15);
  }
}

TEST(Sensing, TakesUniformMotionForWhatWasBeforeTheStart) {
  const std::vector effects{on(0, "sensor_delay", {{"delay", 0.004}})};
  const PlantTerms terms = terms_of(effects);
  const JointVector speed{0.5, 0.0, 0.0};
  Sensing sensing{terms.sensing, kCounts, JointVector::Zero(), speed};
  EXPECT_NEAR(sensing.exact_angles()[0], -0.002, 1e-12);
  sensing.observe(
      {.start_s = 0.0, .duration_s = 1e-3, .qd0 = speed, .q1 = 1e-3 * speed, .qd1 = speed},
      JointVector::Zero());
  EXPECT_NEAR(sensing.exact_angles()[0], -0.0015, 1e-12);
}

TEST(Sensing, CountsUnevenEdgesWhereTheyAre) {
  constexpr double kPhase = 0.3;
  constexpr double kDuty = -0.2;
  const std::vector effects{
      on(0, "quadrature_error", {{"phase_error", kPhase}, {"duty_error", kDuty}})};
  const PlantTerms terms = terms_of(effects);
  const double count = 2.0 * std::numbers::pi / kCounts[0];
  Sensing sensing{terms.sensing, kCounts, JointVector::Zero()};
  const std::array shifts{0.0, kPhase, kDuty, kPhase + kDuty};
  double at = 0.0;
  constexpr double kStep = 0.01;
  for (int k = 0; k < 1200; ++k) {
    const double before = at;
    at = kStep * (k + 1);
    MotionPiece piece{.start_s = 1e-5 * k, .duration_s = 1e-5};
    piece.q0[0] = before * count;
    piece.q1[0] = at * count;
    piece.qd0[0] = piece.qd1[0] = kStep * count / 1e-5;
    sensing.observe(piece, JointVector::Zero());
    const int now = sensing.counts()[0];
    const double lower = now - 0.5 + shifts.at(static_cast<std::size_t>((now + 3) % 4));
    const double upper = now + 0.5 + shifts.at(static_cast<std::size_t>(now % 4));
    EXPECT_GE(at, lower - 1e-9);
    EXPECT_LE(at, upper + 1e-9);
  }
  // Edge to edge, the period counter sees the uneven spacing.
  EXPECT_NE(sensing.period_ticks(0.012)[0], 0);
}

TEST(Sensing, DividesALineAsFineAsTheSineEncoderDoes) {
  const std::vector effects{on(2, "sine_encoder", {{"steps_per_line", 64.0}})};
  const PlantTerms terms = terms_of(effects);
  const Sensing sensing{terms.sensing, kCounts, {0.1, 0.1, 0.1}};
  EXPECT_EQ(sensing.counts_per_rev()[1], kCounts[1]);
  EXPECT_EQ(sensing.counts_per_rev()[2], 16.0 * kCounts[2]);
  EXPECT_LT(std::abs(sensing.angles()[2] - 0.1), std::numbers::pi / (16.0 * kCounts[2]) * 1.0001);
}

TEST(Sensing, AddsTheStretchOfTheTendonUnderTheDeliveredTorque) {
  const std::vector effects{on(1, "tendon_compliance", {{"stiffness", 60.0}})};
  const PlantTerms terms = terms_of(effects);
  Plant plant{phantom(), {.terms = terms}};
  Sensing sensing{terms.sensing, kCounts, JointVector::Zero()};
  plant.set_torque({0.0, 0.03, 0.0});
  plant.advance(1ms, &sensing);
  EXPECT_DOUBLE_EQ(sensing.exact_angles()[1], plant.q()[1] + 0.03 / 60.0);
}

}  // namespace
}  // namespace teleop
