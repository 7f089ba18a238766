#include "core/effects/hand.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/effects/contact.hpp"
#include "core/effects/hand_trace.hpp"
#include "core/model/kinematics.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

const ArmModel& arm() {
  static const ArmModel shipped = load_arm("phantom-1.5");
  return shipped;
}

std::string message_of(std::string_view csv) {
  try {
    [[maybe_unused]] const HandTrace trace = parse_hand_trace(csv, "hand.csv");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

void expect_in(const std::string& part, const std::string& message) {
  EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
}

/// A hand that is there.
Hand hand_of(const std::string& name, const Vector3& start, std::uint64_t seed) {
  std::optional<Hand> hand = make_hand(name, arm(), start, seed, {});
  if (!hand) throw std::runtime_error{"no hand: " + name};
  return *hand;
}

/// Largest jumps of position and speed of a hand over so many intervals.
struct Jumps {
  double position = 0.0;
  double speed = 0.0;
};
Jumps jumps_of(Hand hand, int intervals) {
  Jumps worst;
  for (int k = 0; k < intervals; ++k) {
    const HandKnot end = hand.target(1e-3);
    hand.next_interval();
    const HandKnot begin = hand.target(0.0);
    worst.position = std::max(worst.position, (begin.p - end.p).norm());
    worst.speed = std::max(worst.speed, (begin.v - end.v).norm());
  }
  return worst;
}

HandTrace sine_trace(double step, double length) {
  HandTrace trace{.column = HandTrace::Column::position};
  for (double t = 0.0; t < length + step / 2.0; t += step) {
    const double phase = 2.0 * std::numbers::pi * t;
    trace.t_s.push_back(t);
    trace.values.emplace_back(0.02 * std::sin(phase), 0.01 * std::cos(phase), 0.0);
  }
  return trace;
}

TEST(HandTrace, NamesTheRowOfEveryMistake) {
  expect_in("hand.csv:1: column t_s is missing", message_of(""));
  expect_in("hand.csv:1: column t_s is missing", message_of("q_rad\n0\n"));
  expect_in("hand.csv:1: column z_m is missing", message_of("t_s,x_m,y_m\n0,0,0\n"));
  expect_in("hand.csv:1: is empty", message_of("t_s,q_rad\n"));
  expect_in("two rows", message_of("t_s,q_rad\n0,0\n"));
  expect_in("hand.csv:3: q_rad = 'nan'", message_of("t_s,q_rad\n0,0\n1,nan\n"));
  expect_in("hand.csv:3: q_rad = 'inf'", message_of("t_s,q_rad\n0,0\n1,inf\n"));
  expect_in("hand.csv:3: q_rad = ''", message_of("t_s,q_rad\n0,0\n1,\n"));
  expect_in("hand.csv:2: t_s = '0x'", message_of("t_s,q_rad\n0x,0\n1,0\n"));
  expect_in("hand.csv:4: t_s = 1 after 1", message_of("t_s,q_rad\n0,0\n1,0\n1,0\n"));
  expect_in("hand.csv:3: 1 cells, the head line names 2", message_of("t_s,q_rad\n0,0\n1\n"));
  EXPECT_THROW([[maybe_unused]] const auto t = read_hand_trace("/no/such/trace.csv"), ConfigError);
}

TEST(HandTrace, ReadsBothFormatsOtherColumnsAndWindowsLineEnds) {
  const HandTrace angle = parse_hand_trace("t_s,note,q_rad\r\n0,1,0.5\r\n0.1,1,0.6\r\n\r\n", "a");
  EXPECT_EQ(angle.column, HandTrace::Column::yaw_angle);
  EXPECT_EQ(angle.values[1].x(), 0.6);
  const HandTrace position = parse_hand_trace("t_s, z_m, y_m, x_m\n0,3,2,1\n0.1,6,5,4", "b");
  EXPECT_EQ(position.column, HandTrace::Column::position);
  EXPECT_EQ(position.values[1], (Vector3{4.0, 5.0, 6.0}));
}

TEST(HandTrace, KeepsAClosedMotionAtAnyRate) {
  for (const double step : {0.0004, 0.001, 0.003125, 0.01}) {
    const auto loop = closed_loop_of(sine_trace(step, step * std::round(1.0 / step)), arm());
    const double length = step * std::round(1.0 / step);
    ASSERT_EQ(loop.size(), static_cast<std::size_t>(std::round(length * 1e3)));
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const double t = length * static_cast<double>(k) / static_cast<double>(loop.size());
      const double phase = 2.0 * std::numbers::pi * t;
      EXPECT_NEAR(loop[k].p.x(), 0.02 * std::sin(phase), 5e-5) << step << " at " << t;
      EXPECT_NEAR(loop[k].v.y(), -0.01 * 2.0 * std::numbers::pi * std::sin(phase), 2e-3)
          << step << " at " << t;
    }
  }
}

TEST(HandTrace, TurnsYawAnglesIntoToolPositionsOnTheArmsCircle) {
  HandTrace trace{.column = HandTrace::Column::yaw_angle, .t_s = {0.0, 0.5, 1.0}};
  trace.values = {{0.0, 0.0, 0.0}, {0.2, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const auto loop = closed_loop_of(trace, arm());
  EXPECT_NEAR((loop[500].p - tool_position(arm(), {0.2, 0.0, 0.0})).norm(), 0.0, 1e-9);
}

TEST(HandTrace, BendsAnOpenMotionClosedWithoutAJump) {
  HandTrace open{.column = HandTrace::Column::position};
  for (int i = 0; i <= 200; ++i) {
    open.t_s.push_back(0.01 * i);
    open.values.emplace_back(0.0002 * i, 0.0, 0.0);  // ends 40 mm from its beginning
  }
  const auto loop = closed_loop_of(open, arm());
  const double last_step = (loop.front().p - loop.back().p).norm();
  EXPECT_LT(last_step, 0.3e-3);
  double fastest = 0.0;
  for (const HandKnot& knot : loop) {
    fastest = std::max(fastest, knot.v.norm());
  }
  EXPECT_LT(fastest, 0.2);
}

TEST(Hand, MovesWithoutJumpsFromRestThroughTheSeamOfItsTrace) {
  const Vector3 start{0.001, 0.002, 0.0};
  HandTrace trace = sine_trace(0.01, 0.75);
  const Hand hand{{}, RepeatedMotion{start, closed_loop_of(trace, arm())}};
  EXPECT_EQ(hand.target(0.0).p, start);
  EXPECT_EQ(hand.target(0.0).v, Vector3::Zero());
  const Jumps jumps = jumps_of(hand, 4000);
  EXPECT_LT(jumps.position, 1e-12);
  EXPECT_LT(jumps.speed, 1e-9);
}

TEST(Hand, EntersTheTraceAfterOneSecondAtItsOwnSpeed) {
  const auto loop = closed_loop_of(sine_trace(0.01, 1.0), arm());
  Hand hand{{}, RepeatedMotion{Vector3::Zero(), loop}};
  for (int k = 0; k < 1000; ++k) {
    hand.next_interval();
  }
  EXPECT_NEAR((hand.target(0.0).p - loop[0].p).norm(), 0.0, 1e-15);
  EXPECT_NEAR((hand.target(0.0).v - loop[0].v).norm(), 0.0, 1e-15);
  for (int k = 0; k < 1000; ++k) {
    hand.next_interval();
  }
  EXPECT_NEAR((hand.target(0.0).p - loop[0].p).norm(), 0.0, 1e-15) << "one turn later";
}

TEST(Hand, ReachesWithinItsBoxWithoutJumpsAndReachableByTheArm) {
  Hand hand = hand_of("reach", Vector3::Zero(), 3);
  EXPECT_EQ(hand.target(0.0).v, Vector3::Zero());
  EXPECT_LT(jumps_of(hand, 20000).position, 1e-12);
  Vector3 farthest = Vector3::Zero();
  for (int k = 0; k < 60000; ++k) {
    const Vector3 p = hand.target(0.0).p;
    farthest = farthest.cwiseMax(p.cwiseAbs());
    ASSERT_EQ(inverse_kinematics(arm(), p).reach, Reach::ok) << p.transpose();
    hand.next_interval();
  }
  EXPECT_GT(farthest.minCoeff(), 0.03);
  EXPECT_LT(farthest.x(), 0.061);
}

TEST(Hand, TremblesByATenthOfAMillimetreBetweenEightAndTwelveHertz) {
  ReachMotion motion{{.half_size_m = Vector3::Zero(), .seed = 11}};
  double square = 0.0;
  double square_speed = 0.0;
  constexpr int kKnots = 20000;
  for (int k = 0; k < kKnots + 1000; ++k) {
    const HandKnot knot = motion.next();
    if (k < 1000) continue;
    square += knot.p.squaredNorm() / 3.0 / kKnots;
    square_speed += knot.v.squaredNorm() / 3.0 / kKnots;
  }
  EXPECT_NEAR(std::sqrt(square), 1e-4, 1e-5);
  const double mean_frequency = std::sqrt(square_speed / square) / (2.0 * std::numbers::pi);
  EXPECT_GT(mean_frequency, 8.0);
  EXPECT_LT(mean_frequency, 12.0);
}

TEST(Hand, ReachesTheSameWithTheSameSeedOnly) {
  ReachMotion one{{.seed = 5}};
  ReachMotion same{{.seed = 5}};
  ReachMotion other{{.seed = 6}};
  double difference = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3 p = one.next().p;
    ASSERT_EQ(p, same.next().p);
    difference = std::max(difference, (p - other.next().p).norm());
  }
  EXPECT_GT(difference, 0.01);
}

TEST(Hand, PressesBehindTheSurfaceAndRestsThere) {
  Hand hand = hand_of("press", Vector3::Zero(), 1);
  for (int k = 0; k < 2500; ++k) {
    hand.next_interval();
  }
  EXPECT_NEAR(hand.target(0.0).p.x(), kSurfaceOffset + 0.01, 1e-15);
  EXPECT_NEAR(hand.target(0.0005).v.norm(), 0.0, 1e-12);
}

TEST(Hand, HoldsOrIsAbsentByName) {
  EXPECT_FALSE(make_hand("none", arm(), Vector3::Zero(), 1, {}).has_value());
  const Vector3 start{0.01, 0.02, 0.03};
  Hand hand = hand_of("hold", start, 1);
  hand.next_interval();
  EXPECT_EQ(hand.target(0.0007).p, start);
}

TEST(Hand, PullsByItsLawAndRefusesNegativeNumbers) {
  const Hand hand{{.stiffness_N_per_m = 100.0, .damping_Ns_per_m = 2.0},
                  PointMotion{Vector3::UnitX(), Vector3::UnitX(), std::chrono::seconds{1}}};
  const Vector3 f = hand.pull(0.0, {0.5, 0.0, 0.0}, {0.0, 1.0, 0.0});
  EXPECT_NEAR((f - Vector3{50.0, -2.0, 0.0}).norm(), 0.0, 1e-12);
  const PointMotion still{Vector3::Zero(), Vector3::Zero(), std::chrono::seconds{1}};
  EXPECT_THROW((Hand{{.mass_kg = -1.0}, still}), ConfigError);
  EXPECT_THROW((Hand{{.damping_Ns_per_m = -1.0}, still}), ConfigError);
}

TEST(Hand, FollowsARecordedHandOfAnotherMachine) {
  const std::filesystem::path file =
      TELEOP_SOURCE_DIR "/../shared/recordings/tue-bilateral/hand-reference.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  Hand hand = hand_of(file.string(), Vector3::Zero(), 1);
  const Jumps jumps = jumps_of(hand, 12000);
  EXPECT_LT(jumps.position, 1e-12);
  EXPECT_LT(jumps.speed, 1e-9);
}

TEST(Hand, GoesOnWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Hand reach = hand_of("reach", Vector3::Zero(), 1);
  Hand repeat{{}, RepeatedMotion{Vector3::Zero(), closed_loop_of(sine_trace(0.01, 0.1), arm())}};
  const testing::NoAllocation guard;
  for (int k = 0; k < 3000; ++k) {
    reach.next_interval();
    repeat.next_interval();
  }
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
