#include "core/simulation/encoder_edges.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

/// One count a radian over 2π, so that angles are counts; joints 2 and 3 stand still.
const JointVector count_per_radian = JointVector::Constant(2.0 * std::numbers::pi);

using Motion = std::function<double(double)>;

/// Shows the encoder a motion in pieces.
void show(EncoderEdges& edges, const Motion& q, const Motion& qd, double from, double to) {
  constexpr double kPiece = 1e-3;
  const auto pieces = static_cast<int>(std::lround((to - from) / kPiece));
  for (int i = 0; i < pieces; ++i) {
    const double t0 = from + kPiece * i;
    const double t1 = from + kPiece * (i + 1);
    edges.observe({.start_s = t0,
                   .duration_s = t1 - t0,
                   .q0 = {q(t0), 0.0, 0.0},
                   .qd0 = {qd(t0), 0.0, 0.0},
                   .q1 = {q(t1), 0.0, 0.0},
                   .qd1 = {qd(t1), 0.0, 0.0}});
  }
}

TEST(EncoderEdges, CountsToTheNearestStep) {
  EncoderEdges edges{count_per_radian, {2.4, -2.6, 0.0}};
  EXPECT_EQ(edges.counts(), (std::array<std::int32_t, 3>{2, -3, 0}));
  EXPECT_NEAR((edges.angles() - JointVector{2.0, -3.0, 0.0}).norm(), 0.0, 1e-15);
}

TEST(EncoderEdges, TimesFastSlowAndBackwardMotionToATick) {
  for (const double speed : {0.2e3, 0.9e3, 3.3e3, -5e3, -0.4e3}) {  // counts a second
    EncoderEdges edges{count_per_radian, JointVector::Zero()};
    show(edges, [&](double t) { return speed * t; }, [&](double) { return speed; }, 0.0, 0.1);
    EXPECT_NEAR(edges.period_ticks(0.1)[0], std::copysign(1e7 / std::abs(speed), speed), 1.0);
    EXPECT_EQ(edges.counts()[0], static_cast<std::int32_t>(std::lround(speed * 0.1)));
  }
}

TEST(EncoderEdges, TimesEdgesOfAcceleratedMotion) {
  constexpr double kAcceleration = 4e5;
  EncoderEdges edges{count_per_radian, JointVector::Zero()};
  show(
      edges, [](double t) { return kAcceleration * t * t / 2.0; },
      [](double t) { return kAcceleration * t; }, 0.0, 0.01);
  // At 10 ms: 20 counts; the last edges were at 19.5 and 18.5.
  const double period =
      std::sqrt(2.0 * 19.5 / kAcceleration) - std::sqrt(2.0 * 18.5 / kAcceleration);
  EXPECT_NEAR(edges.period_ticks(0.01)[0], 1e7 * period, 1.0);
}

TEST(EncoderEdges, OverflowsBetweenEdgesAndSinceTheLast) {
  EncoderEdges slow{count_per_radian, JointVector::Zero()};
  show(slow, [](double t) { return 150.0 * t; }, [](double) { return 150.0; }, 0.0, 0.1);
  EXPECT_EQ(slow.period_ticks(0.1)[0], 0) << "6.67 ms between edges";

  EncoderEdges stopped{count_per_radian, JointVector::Zero()};
  show(stopped, [](double t) { return 1e3 * t; }, [](double) { return 1e3; }, 0.0, 0.01);
  EXPECT_NE(stopped.period_ticks(0.016)[0], 0);
  EXPECT_EQ(stopped.period_ticks(0.0165)[0], 0) << "the last edge was at 9.5 ms";
}

TEST(EncoderEdges, StartsWithoutAPeriod) {
  EncoderEdges edges{count_per_radian, {0.4, 0.0, 0.0}};
  EXPECT_EQ(edges.period_ticks(0.0)[0], 0);
  show(edges, [](double t) { return 0.4 + 1e3 * t; }, [](double) { return 1e3; }, 0.0, 0.001);
  EXPECT_EQ(edges.period_ticks(0.001)[0], 0) << "one edge makes no period";
}

TEST(EncoderEdges, SeesBothEdgesOfATurnInsideAPiece) {
  EncoderEdges edges{count_per_radian, JointVector::Zero()};
  // Up to 0.75 at 0.5 ms and back: 0.5 is passed twice within one piece.
  constexpr double kBend = 0.75 / (0.5e-3 * 0.5e-3);
  show(
      edges, [](double t) { return 0.75 - kBend * (t - 0.5e-3) * (t - 0.5e-3); },
      [](double t) { return -2.0 * kBend * (t - 0.5e-3); }, 0.0, 0.001);
  const double apart = 2.0 * std::sqrt(0.25 / kBend);
  EXPECT_EQ(edges.counts()[0], 0);
  EXPECT_NEAR(edges.period_ticks(0.001)[0], -1e7 * apart, 1.0);
}

TEST(EncoderEdges, ObservesWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  EncoderEdges edges{count_per_radian, JointVector::Zero()};
  const MotionPiece piece{
      .duration_s = 1e-3, .qd0 = {1e4, 0, 0}, .q1 = {10, 0, 0}, .qd1 = {1e4, 0, 0}};
  const testing::NoAllocation guard;
  edges.observe(piece);
  [[maybe_unused]] const auto ticks = edges.period_ticks(0.001);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
