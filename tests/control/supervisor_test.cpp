#include "core/control/supervisor.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/control/supervised_pair.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::SupervisedPair;

constexpr std::array kAllModes{Mode::idle, Mode::engaging, Mode::engaged, Mode::holding,
                               Mode::faulted};
constexpr std::array kAllEvents{Event::enable,          Event::disable,   Event::peer_ready,
                                Event::ramp_done,       Event::peer_lost, Event::clutch_pressed,
                                Event::clutch_released, Event::fault,     Event::reset};

TEST(Transitions, AreExactlyThese) {
  struct Cell {
    Mode from;
    Event event;
    Mode to;
  };
  using enum Mode;
  using enum Event;
  constexpr std::array kExpected{
      Cell{idle, enable, idle},
      Cell{idle, disable, idle},
      Cell{idle, peer_ready, engaging},
      Cell{idle, ramp_done, idle},
      Cell{idle, peer_lost, idle},
      Cell{idle, clutch_pressed, idle},
      Cell{idle, clutch_released, idle},
      Cell{idle, fault, faulted},
      Cell{idle, reset, idle},
      Cell{engaging, enable, engaging},
      Cell{engaging, disable, idle},
      Cell{engaging, peer_ready, engaging},
      Cell{engaging, ramp_done, engaged},
      Cell{engaging, peer_lost, holding},
      Cell{engaging, clutch_pressed, holding},
      Cell{engaging, clutch_released, engaging},
      Cell{engaging, fault, faulted},
      Cell{engaging, reset, engaging},
      Cell{engaged, enable, engaged},
      Cell{engaged, disable, idle},
      Cell{engaged, peer_ready, engaged},
      Cell{engaged, ramp_done, engaged},
      Cell{engaged, peer_lost, holding},
      Cell{engaged, clutch_pressed, holding},
      Cell{engaged, clutch_released, engaged},
      Cell{engaged, fault, faulted},
      Cell{engaged, reset, engaged},
      Cell{holding, enable, holding},
      Cell{holding, disable, idle},
      Cell{holding, peer_ready, engaging},
      Cell{holding, ramp_done, holding},
      Cell{holding, peer_lost, holding},
      Cell{holding, clutch_pressed, holding},
      Cell{holding, clutch_released, holding},
      Cell{holding, fault, faulted},
      Cell{holding, reset, holding},
      Cell{faulted, enable, faulted},
      Cell{faulted, disable, faulted},
      Cell{faulted, peer_ready, faulted},
      Cell{faulted, ramp_done, faulted},
      Cell{faulted, peer_lost, faulted},
      Cell{faulted, clutch_pressed, faulted},
      Cell{faulted, clutch_released, faulted},
      Cell{faulted, fault, faulted},
      Cell{faulted, reset, idle},
  };
  static_assert(kExpected.size() == kModes * kEvents);
  for (const Cell& cell : kExpected) {
    EXPECT_EQ(next_mode(cell.from, cell.event), cell.to)
        << name_of(cell.from) << ", event " << static_cast<int>(cell.event);
  }
}

TEST(Transitions, LeaveFaultedByResetAloneAndReachItByFaultAlone) {
  for (const Mode mode : kAllModes) {
    for (const Event event : kAllEvents) {
      const Mode next = next_mode(mode, event);
      if (mode == Mode::faulted) {
        EXPECT_EQ(next != Mode::faulted, event == Event::reset);
      } else {
        EXPECT_EQ(next == Mode::faulted, event == Event::fault);
      }
    }
  }
}

TEST(Transitions, ReachEngagedOnlyThroughEngaging) {
  for (const Mode mode : kAllModes) {
    for (const Event event : kAllEvents) {
      if (next_mode(mode, event) != Mode::engaged || mode == Mode::engaged) continue;
      EXPECT_EQ(mode, Mode::engaging);
      EXPECT_EQ(event, Event::ramp_done);
    }
  }
}

TEST(Supervisor, KeepsTheAmplifiersOffUntilEnabled) {
  SupervisedPair pair;
  pair.run(50);
  EXPECT_FALSE(pair.master.out.amplifiers);
  EXPECT_EQ(pair.master.out.mode, Mode::idle);
}

TEST(Supervisor, WaitsInIdleWithAmplifiersOnForAPeerThatIsNotEnabled) {
  SupervisedPair pair;
  pair.master.enable = true;
  pair.run(50);
  EXPECT_TRUE(pair.master.out.amplifiers);
  EXPECT_EQ(pair.master.out.mode, Mode::idle);
  EXPECT_EQ(pair.master.out.ramp, 0.0);
}

TEST(Supervisor, BothSidesEngageWithinTheRampAndAHandshake) {
  SupervisedPair pair;
  pair.enable_both();
  pair.run(310);
  EXPECT_EQ(pair.master.out.mode, Mode::engaged);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.master.out.ramp, 1.0);
  EXPECT_EQ(pair.master.out.epoch, 1001U);
  EXPECT_EQ(pair.slave.out.epoch, 1001U);
}

TEST(Supervisor, TakesBothReferencesWhereTheToolsStandAtEngaging) {
  SupervisedPair pair;
  pair.master.p = {0.05, 0.0, 0.0};
  pair.slave.p = {0.0, -0.04, 0.0};
  pair.enable_both();
  pair.run(310);
  EXPECT_EQ(pair.master.out.reference, pair.master.p);
  EXPECT_EQ(pair.slave.out.reference, pair.slave.p);
}

TEST(Supervisor, HoldsWithNoCouplingWithinTwentyMillisecondsOfTheLastPacket) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.connected = false;
  int ticks = 0;
  while (pair.slave.out.ramp > 0.0 && ticks < 100) {
    pair.run(1);
    ++ticks;
  }
  EXPECT_LE(ticks, 20);
  EXPECT_EQ(pair.slave.out.mode, Mode::holding);
  EXPECT_TRUE(pair.slave.out.amplifiers);
  EXPECT_TRUE(pair.slave.out.limits.has(Limit::peer_silent));
}

TEST(Supervisor, KeepsItsReferencesOverAShortSilence) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.connected = false;
  pair.run(100);
  pair.master.p.x() += 0.009;  // the operator goes on, below the limit
  pair.connected = true;
  pair.run(400);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.master.out.epoch, 1001U) << "the slave must make up for the motion it missed";
}

TEST(Supervisor, BeginsAnewWhereAPeerReturnsTooFarApart) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.connected = false;
  pair.run(100);
  pair.master.p.x() += 0.011;
  pair.connected = true;
  pair.run(400);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.master.out.epoch, 1002U);
  EXPECT_EQ(pair.slave.out.epoch, 1002U);
  EXPECT_EQ(pair.master.out.reference, pair.master.p);
}

TEST(Supervisor, ClutchOfEitherSideReleasesBothAndResyncs) {
  for (const bool at_master : {true, false}) {
    SupervisedPair pair = SupervisedPair::engaged();
    auto& side = at_master ? pair.master : pair.slave;
    side.clutch = true;
    pair.run(20);
    EXPECT_EQ(pair.master.out.mode, Mode::holding);
    EXPECT_EQ(pair.slave.out.mode, Mode::holding);
    EXPECT_EQ(pair.master.out.ramp + pair.slave.out.ramp, 0.0);
    side.p.y() += 0.005;  // below the resync limit: the clutch alone asks for new references
    side.clutch = false;
    pair.run(320);
    EXPECT_EQ(pair.master.out.mode, Mode::engaged);
    EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
    EXPECT_EQ(side.out.reference, side.p);
  }
}

TEST(Supervisor, AFaultStopsThisSideAndMakesThePeerHold) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.slave.fault = Fault::encoder_jump;
  pair.run(1);
  EXPECT_EQ(pair.slave.out.mode, Mode::faulted);
  EXPECT_FALSE(pair.slave.out.amplifiers);
  EXPECT_EQ(pair.slave.out.ramp, 0.0);
  pair.slave.fault = Fault::none;
  pair.run(15);
  EXPECT_EQ(pair.slave.out.fault, Fault::encoder_jump) << "shown until reset";
  EXPECT_EQ(pair.master.out.mode, Mode::holding);
  EXPECT_EQ(pair.master.out.fault, Fault::peer_faulted);
  EXPECT_TRUE(pair.master.out.amplifiers);
}

TEST(Supervisor, ResetNeedsTheFaultGoneAndANewEnable) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.slave.fault = Fault::device_unplugged;
  pair.run(1);
  pair.slave.reset = true;
  pair.run(1);
  EXPECT_EQ(pair.slave.out.mode, Mode::faulted) << "the fault is still there";
  pair.slave.fault = Fault::none;
  pair.slave.reset = true;
  pair.run(5);
  EXPECT_EQ(pair.slave.out.mode, Mode::idle);
  EXPECT_FALSE(pair.slave.out.amplifiers);
  pair.slave.enable = true;
  pair.run(320);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.master.out.mode, Mode::engaged);
}

TEST(Supervisor, AFailedRecordingIsShownAndChangesNothing) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.slave.fault = Fault::recording_failed;
  pair.run(5);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.slave.out.fault, Fault::recording_failed);
}

TEST(Supervisor, DisableReleasesTheCouplingBeforeTheAmplifiersGoOff) {
  SupervisedPair pair = SupervisedPair::engaged();
  pair.master.disable = true;
  pair.run(1);
  EXPECT_EQ(pair.master.out.mode, Mode::idle);
  EXPECT_TRUE(pair.master.out.amplifiers);
  pair.run(8);
  EXPECT_EQ(pair.master.out.ramp, 0.0);
  EXPECT_FALSE(pair.master.out.amplifiers);
  EXPECT_EQ(pair.master.out.epoch, 0U) << "who takes no part publishes no epoch";
  EXPECT_EQ(pair.slave.out.mode, Mode::holding);
}

TEST(Supervisor, ReleasesInExactlyTheTimeAskedForWhateverItsRounding) {
  for (int release_ms = 1; release_ms <= 20; ++release_ms) {
    SupervisedPair pair = SupervisedPair::engaged({.release_ms = 1.0 * release_ms});
    pair.master.disable = true;
    pair.run(release_ms - 1);
    EXPECT_GT(pair.master.out.ramp, 0.0) << release_ms << " ms";
    pair.run(1);
    EXPECT_EQ(pair.master.out.ramp, 0.0) << release_ms << " ms";
  }
}

TEST(Supervisor, NeverTrustsAnEpochOfAProgramThatRestarted) {
  for (const bool at_master : {true, false}) {
    SupervisedPair pair = SupervisedPair::engaged();
    (at_master ? pair.master : pair.slave).restart();
    pair.master.p.x() += 0.002;  // well below the resync limit
    (at_master ? pair.master : pair.slave).enable = true;
    pair.run(330);
    EXPECT_EQ(pair.master.out.mode, Mode::engaged);
    EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
    EXPECT_EQ(pair.master.out.reference, pair.master.p) << "an old reference survived";
    EXPECT_EQ(pair.slave.out.reference, pair.slave.p);
  }
}

TEST(Supervisor, ShowsTheLawOnlyPeerStatesOfTheOwnEpochWhileCoupled) {
  // The slave hears of the new epoch without having heard of the clutch before it.
  SupervisedPair pair = SupervisedPair::engaged();
  pair.connected = false;
  pair.master.clutch = true;
  pair.run(9);
  pair.master.p.x() += 0.2;
  pair.master.clutch = false;
  pair.connected = true;
  for (int k = 0; k < 7; ++k) {
    pair.run(1);
    if (pair.slave.out.ramp == 0.0) break;
    EXPECT_EQ(pair.slave.out.peer.epoch, pair.slave.out.epoch);
    EXPECT_NEAR(pair.slave.out.peer.p_BT.x(), 0.0, 1e-12);
  }
  pair.run(320);
  EXPECT_EQ(pair.slave.out.mode, Mode::engaged);
  EXPECT_EQ(pair.slave.out.epoch, 1002U);
}

TEST(Supervisor, RejectsTimesThatAreNotPositive) {
  const PositionError law{{}, Role::master};
  EXPECT_THROW((Supervisor{{.engage_ms = 0.0}, law, 0}), ConfigError);
  EXPECT_THROW((Supervisor{{.resync_limit_mm = std::numeric_limits<double>::quiet_NaN()}, law, 0}),
               ConfigError);
}

TEST(Supervisor, TakesItsTimesFromSettings) {
  Supervisor::Config config;
  Settings settings;
  add_settings(settings, "supervisor.", config);
  settings.load_text("[supervisor]\nlink_timeout_ms = 50\n", "side.toml");
  EXPECT_EQ(config.link_timeout_ms, 50.0);
  EXPECT_THROW(settings.set("supervisor.release_ms", "0", "command line"), ConfigError);
}

TEST(Supervisor, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Supervisor supervisor{{}, PositionError{{}, Role::master}, 0};
  Supervisor::Input input{.enable = true};
  input.peer.emplace();
  input.peer->session = 7;
  const testing::NoAllocation guard;
  supervisor.step(input, 1e-3);
  supervisor.step(input, 1e-3);
  EXPECT_EQ(guard.count(), 0U);
}

}  // namespace
}  // namespace teleop
