#include "core/diagnosis/case_logs.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/audit_motion.hpp"
#include "core/model/kinematics.hpp"
#include "core/recording/log_writer.hpp"
#include "core/simulation/pair.hpp"
#include "tests/diagnosis_input/made_runs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::TemporaryFolder;

struct Session {
  Log master;
  Log slave;
};

Metadata metadata_of(Role role) {
  return {
      {"role", name_of(role)}, {"arm", "phantom-1.5"}, {"rate_Hz", "1000"}, {"config", "[law]"}};
}

/// A teleoperation on simulated time, as the programs record it.
Session teleoperate(double seconds) {
  SimulatedPair::Config config;
  config.master = {.plant = load_plant("phantom-1.5"), .hand = "reach"};
  config.slave = {.plant = load_plant("phantom-1.5")};
  SimulatedPair pair{config};
  Session session{.master = {.file = "master.mcap", .metadata = metadata_of(Role::master)},
                  .slave = {.file = "slave.mcap", .metadata = metadata_of(Role::slave)}};
  for (int k = 0; k < static_cast<int>(1e3 * seconds); ++k) {
    pair.step();
    session.master.ticks.push_back(pair.master());
    session.slave.ticks.push_back(pair.slave());
  }
  return session;
}

const Session& session() {
  static const Session once = teleoperate(3.0);
  return once;
}

std::size_t first_with_amplifiers(const Log& log) {
  const auto on = std::find_if(log.ticks.begin(), log.ticks.end(), [](const TickRecord& tick) {
    return (tick.arm_flags & static_cast<std::uint32_t>(ArmFlag::amplifiers_on)) != 0;
  });
  return static_cast<std::size_t>(on - log.ticks.begin());
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    text += line + '\n';
  }
  return text;
}

TEST(CaseLogs, AWholeLogIsOneRunWhileTheAmplifiersAreOn) {
  const Log& log = session().slave;
  const std::size_t first = first_with_amplifiers(log);
  ASSERT_LT(first, 500U);

  const std::vector<Recording> runs = runs_of(log);

  ASSERT_EQ(runs.size(), 1U);
  const Recording& run = runs.front();
  EXPECT_EQ(run.name, "slave.mcap");
  EXPECT_EQ(run.rows(), log.ticks.size() - first);
  EXPECT_EQ(run.first_row, first + 1);
  EXPECT_EQ(run.about.at("config"), "[law]");
  EXPECT_TRUE(run.notes.empty()) << joined(run.notes);
  for (std::size_t k = 0; k < run.rows(); k += 97) {
    const TickRecord& tick = log.ticks[first + k];
    EXPECT_EQ(run.q[k], JointVector{tick.q_rad});
    EXPECT_EQ(run.tau[k], JointVector{tick.tau_Nm});
    EXPECT_NEAR(run.t_s[k], 1e-3 * static_cast<double>(first + k), 1e-9);
  }
}

/// The hand's force on the tool is what the arm exerts on the hand, turned round.
TEST(CaseLogs, TellsTheForceThatTheArmFelt) {
  const Log& log = session().master;
  const ArmModel arm = load_arm("phantom-1.5");
  const Recording run = runs_of(log).front();
  ASSERT_EQ(run.contact.size(), run.rows());
  double largest = 0.0;
  for (std::size_t k = 0; k < run.rows(); ++k) {
    const TickRecord& tick = log.ticks[run.first_row - 1 + k];
    const Vector3 force = -linear_jacobian(arm, run.q[k]).transpose().inverse() * run.contact[k];
    ASSERT_LT((force - tick.tool_force_N).norm(), 1e-9);
    largest = std::max(largest, tick.tool_force_N.norm());
  }
  EXPECT_GT(largest, 0.1);
}

/// Commands less the felt force are what the inertia takes, or one of the two has a wrong sign.
TEST(CaseLogs, CommandsAndFeltForceTogetherMoveTheArm) {
  const DiagnosisCase of{};
  const ArmModel arm = load_arm("phantom-1.5");
  std::size_t clear = 0;
  for (const Log* log : {&session().master, &session().slave}) {
    const CommandFit fit = fit_commands(of, &arm, runs_of(*log).front()).value_or(CommandFit{});
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (fit.correlation(i, i) < 0.8) continue;
      EXPECT_NEAR(fit.share(i, i), 1.0, 0.25) << log->file << " axis " << i + 1;
      ++clear;
    }
  }
  EXPECT_GE(clear, 3U);
}

TEST(CaseLogs, MeasuredTorquesFollowTheCommands) {
  const Recording run = runs_of(session().slave).front();
  ASSERT_EQ(run.measured.size(), run.rows());
  for (std::size_t k = 100; k < run.rows(); k += 53) {
    EXPECT_LT((run.measured[k] - run.tau[k - 1]).norm(), 0.02 + 0.1 * run.tau[k - 1].norm()) << k;
  }
}

TEST(CaseLogs, SoundLogsPassTheAudit) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const auto& [role, log] :
       {std::pair{Role::master, &session().master}, std::pair{Role::slave, &session().slave}}) {
    files.push_back(folder.path() / log->file);
    LogWriter writer{{.file = files.back(), .role = role, .metadata = log->metadata}};
    for (const TickRecord& tick : log->ticks) {
      writer.append(tick);
    }
    writer.close();
  }

  const std::vector<DiagnosisCase> cases = read_log_cases(files);

  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[0].name, "master");
  EXPECT_EQ(cases[1].name, "slave");
  for (const DiagnosisCase& each : cases) {
    EXPECT_EQ(each.plant, "phantom-1.5");
    EXPECT_DOUBLE_EQ(each.period_s, 1e-3);
    EXPECT_NEAR(each.resolution[0] * 54476.8, 6.283185307, 1e-8);
    EXPECT_EQ(each.runs.size(), 1U);
    for (const Finding& finding : audit(each).findings) {
      ADD_FAILURE() << finding.kind << ": " << line_of(finding);
    }
  }
}

TEST(CaseLogs, TwoLogsOfOneMachineAreTwoRunsOfOneCase) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directory(folder.path() / name);
    files.push_back(folder.path() / name / "slave.mcap");
    LogWriter writer{
        {.file = files.back(), .role = Role::slave, .metadata = session().slave.metadata}};
    for (const TickRecord& tick : session().slave.ticks) {
      writer.append(tick);
    }
    writer.close();
  }
  const std::vector<DiagnosisCase> cases = read_log_cases(files);
  ASSERT_EQ(cases.size(), 1U);
  ASSERT_EQ(cases[0].runs.size(), 2U);
  EXPECT_NE(cases[0].runs[0].name, cases[0].runs[1].name);
}

TEST(CaseLogs, LostTurnsEndARun) {
  Log log = session().slave;
  log.ticks.erase(log.ticks.begin() + 1500, log.ticks.begin() + 1503);

  const std::vector<Recording> runs = runs_of(log);

  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].first_row + runs[0].rows(), 1501U);
  EXPECT_EQ(runs[1].first_row, 1501U);
  EXPECT_EQ(runs[1].q.front(), JointVector{log.ticks[1500].q_rad});
  EXPECT_NE(runs[0].name, runs[1].name);
  EXPECT_NE(joined(runs[0].notes).find("first at record 1501"), std::string::npos)
      << joined(runs[0].notes);
}

TEST(CaseLogs, ALateTurnEndsARunAndALittleLatenessDoesNot) {
  Log log = session().slave;
  log.ticks[1200].stamp_ns += 300'000;
  EXPECT_EQ(runs_of(log).size(), 1U);
  log.ticks[1200].stamp_ns += 400'000;
  const std::vector<Recording> runs = runs_of(log);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].first_row + runs[0].rows(), 1201U);
}

TEST(CaseLogs, TurnsWithoutTorqueOrReadingAreLeftOut) {
  Log log = session().slave;
  log.ticks[1000].arm_flags |= static_cast<std::uint32_t>(ArmFlag::watchdog_tripped);
  log.ticks[2000].q_rad[1] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Recording> runs = runs_of(log);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[1].first_row, 1002U);
  EXPECT_EQ(runs[1].rows(), 999U);
  EXPECT_NE(joined(runs[0].notes).find("2 turn(s)"), std::string::npos) << joined(runs[0].notes);
}

TEST(CaseLogs, ShortStretchesAreLeftOutAndSaidSo) {
  Log log = session().slave;
  log.ticks[1000].stamp_ns += 700'000;  // after it the turns are back on the grid
  log.ticks[1200].stamp_ns += 700'000;
  const std::vector<Recording> runs = runs_of(log);
  EXPECT_EQ(runs.size(), 2U);
  EXPECT_NE(joined(runs[0].notes).find("shorter than 0.5 s"), std::string::npos);
}

TEST(CaseLogs, TheRecordOfTheStopIsNoTurn) {
  Log log = session().slave;
  TickRecord last = log.ticks.back();
  last.stamp_ns += 1'000'000;
  last.mode = 0;
  last.tau_Nm.setZero();
  const std::size_t rows = runs_of(log).front().rows();
  log.ticks.push_back(last);
  EXPECT_EQ(runs_of(log).front().rows(), rows);
}

void expect_refusal(const Log& log, const std::string& words) {
  try {
    static_cast<void>(runs_of(log));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with("slave.mcap: ")) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
}

TEST(CaseLogs, NamesWhatALogLacks) {
  Log log = session().slave;
  log.metadata.erase("arm");
  expect_refusal(log, "does not say 'arm'");
  log = session().slave;
  log.metadata["rate_Hz"] = "fast";
  expect_refusal(log, "rate_Hz = 'fast'");
  log.metadata["rate_Hz"] = "500";
  expect_refusal(log, "turns every 2 ms");
  log = session().slave;
  log.ticks[7].q_rad[2] += 3e-5;
  expect_refusal(log, "record 8");
  log = session().slave;
  for (TickRecord& tick : log.ticks) {
    tick.arm_flags = 0;
  }
  expect_refusal(log, "amplifiers on");
}

}  // namespace
}  // namespace teleop
