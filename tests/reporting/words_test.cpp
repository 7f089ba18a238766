#include "core/reporting/words.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/reporting/run_of.hpp"

namespace teleop {
namespace {

using testing::log_of;
using testing::LogOf;
using testing::set;
using testing::set_tool_force;
using testing::sine;

/// Whether one of the sentences contains the text.
bool says(const std::vector<std::string>& sentences, const std::string& text) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
    return sentence.find(text) != std::string::npos;
  });
}

Words words_of(const LogOf& master, const LogOf& slave) {
  return describe(measure(std::vector<Log>{log_of(master), log_of(slave)}));
}

TEST(Words, OfACleanRunSayHowLongHowCloseAndThatNothingWentWrong) {
  const Words words =
      words_of({.role = Role::master, .seconds = 10.0, .position = sine(0.05, 1.0)},
               {.role = Role::slave, .seconds = 10.0, .position = sine(0.05, 1.0, 0.003)});
  EXPECT_EQ(words.headline, "A clean run");
  EXPECT_TRUE(words.troubles.empty());
  EXPECT_TRUE(says(words.story, "The pair ran for 10.0 s at 1000 Hz"));
  EXPECT_TRUE(says(words.story, "within 0.67 mm RMS (peak 0.9 mm)"));
  EXPECT_TRUE(says(words.story, "No packet was lost of 20002"));
}

TEST(Words, OfALinkThatReturnsSayWhenAndForHowLong) {
  const auto silent = [](TickRecord& r, double t) {
    if (t >= 0.5 && t < 0.75) set(r, Limit::peer_silent);
    r.packets_lost = t > 0.5 ? 250 : 0;
  };
  const Words words = words_of({.role = Role::master, .change = silent}, {.role = Role::slave});
  EXPECT_EQ(words.headline, "The link was lost and came back");
  EXPECT_TRUE(
      says(words.troubles, "From 0.50 s the master heard nothing from the slave for 250 ms."));
  EXPECT_TRUE(says(words.story, "250 of 4252 packets were lost (5.88 %)"));
}

TEST(Words, OfAMomentOfSilenceRemarkItWithoutCallingTheLinkLost) {
  const auto silent = [](TickRecord& r, double t) {
    const bool last = t > 0.5 && t < 0.5125;
    r.peer_received_ns = last ? 5'500'000'000 : r.stamp_ns;
    if (last && t >= 0.510) set(r, Limit::peer_silent);
  };
  const Words words = words_of({.role = Role::master, .change = silent}, {.role = Role::slave});
  EXPECT_EQ(words.headline, "A run with remarks");
  EXPECT_TRUE(
      says(words.troubles, "From 0.50 s the master heard nothing from the slave for 13 ms."));
}

TEST(Words, OfAPeerThatIsGoneSayThatItDidNotReturn) {
  const auto silent = [](TickRecord& r, double t) {
    if (t >= 0.5) set(r, Limit::peer_silent);
    if (t >= 0.51) set(r, Mode::holding);
  };
  const Words words =
      words_of({.role = Role::master, .change = silent}, {.role = Role::slave, .seconds = 0.5});
  EXPECT_EQ(words.headline, "The link was lost and did not return");
  EXPECT_TRUE(says(words.troubles, "for 1.5 s, and it did not return."));
}

TEST(Words, OfAFaultNameItsSideTimeNumberAndCause) {
  const Words words =
      words_of({.role = Role::master}, {.role = Role::slave, .change = [](TickRecord& r, double t) {
                                          if (t > 0.9995) r.fault = 1;
                                        }});
  EXPECT_EQ(words.headline, "A fault ended the coupling");
  EXPECT_TRUE(says(words.troubles,
                   "At 1.00 s the slave reported fault 1 (device_unplugged): "
                   "the device no longer answers."));
}

TEST(Words, OfOneSideSpeakOfThatSideOnly) {
  const Words words = describe(
      measure(std::vector<Log>{log_of({.role = Role::slave, .change = [](TickRecord& r, double) {
                                         r.error_m.x() = 1e-3;
                                       }})}));
  EXPECT_EQ(words.headline, "A clean run");
  EXPECT_TRUE(says(words.story, "This is the slave alone; it ran for 2.0 s"));
  EXPECT_TRUE(says(words.story, "age of the master's data in it, was 1.00 mm RMS"));
  EXPECT_FALSE(says(words.story, "pair"));
}

TEST(Words, OfAPressOnAWallCompareTheTwoForces) {
  const Words words = words_of({.role = Role::master,
                                .change =
                                    [](TickRecord& r, double) {
                                      set_tool_force(r, {2.04, 0.0, 0.0});
                                    }},
                               {.role = Role::slave, .change = [](TickRecord& r, double) {
                                  set_tool_force(r, {-2.0, 0.0, 0.0});
                                }});
  EXPECT_TRUE(says(words.story,
                   "held 1.02 times the force of the surroundings "
                   "(2.04 N against 2.00 N)"));
}

TEST(Words, OfSidesThatNeverMetSaySo) {
  const auto idle = [](TickRecord& r, double) {
    set(r, Mode::idle);
    r.peer_session = 0;
    r.packets_received = 0;
  };
  const Words words =
      words_of({.role = Role::master, .change = idle}, {.role = Role::slave, .change = idle});
  EXPECT_EQ(words.headline, "The two sides were never engaged together");
  EXPECT_TRUE(says(words.story, "No packet arrived."));
}

TEST(Words, OfManyFaultsTellTheFirstAndCountTheRest) {
  const Words words =
      words_of({.role = Role::master}, {.role = Role::slave, .change = [](TickRecord& r, double) {
                                          r.fault = r.tick % 100 == 50 ? 51 : 0;
                                        }});
  EXPECT_EQ(words.headline, "A run with remarks");
  EXPECT_TRUE(says(words.troubles, "And 15 faults more."));
  EXPECT_EQ(words.troubles.size(), 6U);
}

TEST(Words, NameWhatTheLoopTheRecordingAndTheLawDidWrong) {
  Log master = log_of({.role = Role::master, .change = [](TickRecord& r, double) {
                         r.energy_J = 0.5;
                         if (r.tick < 3) set(r, Limit::overrun);
                       }});
  Log slave = log_of({.role = Role::slave, .rate_Hz = 900.0});
  slave.metadata["rate_Hz"] = "1000";
  slave.complete = false;
  slave.damage = "cut off after 1.9 s";
  master.ticks.erase(master.ticks.begin() + 10);

  const Words words = describe(measure(std::vector<Log>{master, slave}));

  EXPECT_EQ(words.headline, "A run with remarks");
  EXPECT_TRUE(says(words.troubles, "3 turns of the master ran past their period."));
  EXPECT_TRUE(says(words.troubles, "lacks 1 turn that the recording dropped"));
  EXPECT_TRUE(says(words.troubles, "The slave did only 90 % of the turns"));
  EXPECT_TRUE(says(words.troubles, "not whole: cut off after 1.9 s."));
  EXPECT_TRUE(says(words.troubles, "it was not passive"));
}

}  // namespace
}  // namespace teleop
