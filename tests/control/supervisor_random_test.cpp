#include <algorithm>
#include <array>
#include <deque>

#include <gtest/gtest.h>

#include "tests/control/supervised_pair.hpp"
#include "tests/model/postures.hpp"

namespace teleop {
namespace {

using testing::random_vector;
using testing::SupervisedSide;

constexpr double kStiffness = PositionError::Config{}.stiffness_slave_N_per_m;

/// One side among random events, and what the property needs to remember of its last turn.
struct Side {
  explicit Side(Role role) : sup{role}, law{{}, role} {}

  /// The coupling force as the loop forms it.
  [[nodiscard]] Vector3 pull() const {
    return law
        .step({.displacement = sup.p - sup.out.reference, .velocity = Vector3::Zero()},
              {.displacement = sup.out.peer.p_BT - sup.out.peer.reference,
               .velocity = Vector3::Zero()})
        .force;
  }

  SupervisedSide sup;
  PositionError law;
  Vector3 drift = Vector3::Zero();
  std::deque<PeerSample> flight;  ///< sent by this side
};

void disturb(Side& side, Random& random) {
  const auto happens = [&](double probability) {
    return random.uniform() < probability;
  };
  SupervisedSide& s = side.sup;
  if (happens(s.clutch ? 0.02 : 0.0005)) s.clutch = !s.clutch;
  s.disable = happens(0.0005);
  s.enable = happens(0.05);
  s.reset = happens(0.02);
  s.fault = happens(0.0003) ? Fault::encoder_jump : Fault::none;
  if (happens(0.01)) side.drift = random_vector(random, 0.5);  // m/s
  if (happens(0.0002)) s.restart();
}

void exchange(std::array<Side, 2>& sides, bool connected, Instant now, Random& random) {
  for (std::size_t i = 0; i < 2; ++i) {
    auto& flight = sides.at(i).flight;
    flight.push_back(sides.at(i).sup.packet());
    while (flight.size() > 1 && random.uniform() < 0.6) {
      PeerSample arrived = flight.front();
      flight.pop_front();
      arrived.received = now;
      if (connected && random.uniform() < 0.9) sides.at(1 - i).sup.newest = arrived;
    }
  }
}

/// One turn of a side: ramp and force may change only as far as time and motion allow.
void turn_and_check(Side& side, Instant now, double dt) {
  const Supervisor::Output before = side.sup.out;
  const Vector3 pull_before = side.pull();
  side.sup.p += side.drift * dt;
  side.sup.turn(now, dt);
  const Supervisor::Output& after = side.sup.out;
  if (after.mode == Mode::faulted) {
    ASSERT_EQ(after.ramp, 0.0);
    ASSERT_FALSE(after.amplifiers);
    return;
  }
  const double rise = after.ramp - before.ramp;
  ASSERT_LE(rise, dt / 0.300 + 1e-12);
  ASSERT_GE(rise, -dt / 0.008 - 1e-9);

  const double motion = side.drift.norm() * dt + (after.peer.p_BT - before.peer.p_BT).norm();
  const double allowed = std::abs(rise) * std::max(side.pull().norm(), pull_before.norm()) +
                         std::min(before.ramp, after.ramp) * kStiffness * motion;
  const Vector3 jump = after.ramp * side.pull() - before.ramp * pull_before;
  ASSERT_LE(jump.norm(), allowed + 1e-9);
}

TEST(Supervisor, NeverJumpsInRampOrForceUnderAnySequenceOfEvents) {
  Random random{31};
  const int turns = 100 * testing::cases();
  std::array<Side, 2> sides{Side{Role::master}, Side{Role::slave}};
  Instant now{};
  bool connected = true;
  int engaged = 0;
  for (int k = 0; k < turns; ++k) {
    const auto period = std::chrono::microseconds{500 + random.bits() % 1000};
    now += period;
    if (random.uniform() < (connected ? 0.001 : 0.02)) connected = !connected;
    for (Side& side : sides) {
      disturb(side, random);
      turn_and_check(side, now, seconds(period));
      if (::testing::Test::HasFatalFailure()) FAIL() << "in turn " << k;
      engaged += side.sup.out.mode == Mode::engaged ? 1 : 0;
    }
    exchange(sides, connected, now, random);
  }
  EXPECT_GT(engaged, turns / 100) << "the events never let the sides couple";
}

}  // namespace
}  // namespace teleop
