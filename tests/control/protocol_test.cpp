#include <string>

#include <gtest/gtest.h>

#include "tests/control/protocol_exploration.hpp"

namespace teleop {
namespace {

using testing::explore;
using testing::ProtocolActions;
using testing::ProtocolWorld;
using testing::SupervisedSide;

/// A side whose coupling rises does so with a slave's reference taken in the master's present
/// session.
void expect_own_sessions(const ProtocolWorld& world, std::size_t i) {
  const SupervisedSide& side = world.side.at(i);
  if (side.role == Role::slave) {
    ASSERT_EQ(side.latched_in, side.supervisor.state().peer_session);
  } else {
    ASSERT_EQ(side.supervisor.state().peer.tick, side.session);
  }
}

/// What every transition has to keep.
void expect_safe(const ProtocolWorld& before, const ProtocolWorld& after) {
  const Supervisor::State& m = after.side[0].supervisor.state();
  const Supervisor::State& s = after.side[1].supervisor.state();
  if (m.ramp > 0.0 && s.ramp > 0.0) {
    ASSERT_EQ(m.epoch, s.epoch) << "coupled with references of two epochs";
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const Supervisor::State& was = before.side.at(i).supervisor.state();
    const Supervisor::State& is = after.side.at(i).supervisor.state();
    if (is.ramp > was.ramp) {
      ASSERT_EQ(is.peer.epoch, is.epoch);
      ASSERT_TRUE(is.mode == Mode::engaging || is.mode == Mode::engaged);
      ASSERT_TRUE(is.peer.mode == Mode::engaging || is.peer.mode == Mode::engaged);
      ASSERT_FALSE(is.clutch);
      expect_own_sessions(after, i);
    }
    const bool restarted = after.restarts != before.restarts;
    if (was.ramp > 0.0 && !restarted) {
      ASSERT_EQ(is.reference, was.reference) << "the own reference moved under load";
    }
    if (was.ramp > 0.0 && is.ramp > 0.0) {
      ASSERT_EQ(is.peer.reference, was.peer.reference) << "the peer's reference moved under load";
    }
    if (is.mode == Mode::faulted) {
      ASSERT_EQ(is.ramp, 0.0);
    }
  }
}

void expect_safe_and_live(const ProtocolActions& actions) {
  std::size_t stuck = 0;
  const std::size_t worlds = explore(
      actions,
      [](const ProtocolWorld& before, const ProtocolWorld& after) { expect_safe(before, after); },
      [&](const ProtocolWorld& world) {
        if (!world.gets_engaged(false) || !world.gets_engaged(true)) ++stuck;
      });
  EXPECT_EQ(stuck, 0U) << "worlds that never get to engaged, of " << worlds;
  EXPECT_GT(worlds, 1000U) << "an exploration this small has missed something";
  ::testing::Test::RecordProperty("worlds", std::to_string(worlds));
}

TEST(Protocol, IsSafeAndLiveUnderDelayAndLoss) { expect_safe_and_live({}); }

TEST(Protocol, IsSafeAndLiveUnderClutches) { expect_safe_and_live({.clutches = true}); }

TEST(Protocol, IsSafeAndLiveUnderMotionDuringSilence) { expect_safe_and_live({.motion = true}); }

TEST(Protocol, IsSafeAndLiveUnderFaults) { expect_safe_and_live({.faults = true}); }

TEST(Protocol, IsSafeAndLiveUnderDisabling) { expect_safe_and_live({.disabling = true}); }

TEST(Protocol, IsSafeAndLiveUnderRestarts) { expect_safe_and_live({.restarts = 1}); }

}  // namespace
}  // namespace teleop
