#include "scenarios/diagnose.hpp"

#include <csignal>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/diagnosis/case_logs.hpp"
#include "core/experiment/scenario.hpp"
#include "core/identification/probe_motion.hpp"
#include "core/program/stop_signal.hpp"
#include "scenarios/run.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

std::string text_of(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

int play(const fs::path& scenario, const std::vector<std::string>& settings = {}) {
  RunOptions options;
  options.scenario = scenario.string();
  options.settings = settings;
  return run_scenario(options);
}

/// Plays a motion on a simulated arm with one effect. @returns the log.
fs::path record(const TemporaryFolder& folder, const std::string& motion, double seconds) {
  const fs::path log = folder.path() / (motion + ".mcap");
  const fs::path scenario = folder.path() / (motion + ".toml");
  std::ofstream{scenario} << "experiment = \"probe\"\n[run]\nmotion = \"" << motion
                          << "\"\nlog = \"" << log.string() << "\"\nseconds = " << seconds
                          << "\n[plant]\narm = \"phantom-1.5\"\n[[plant.effect]]\n"
                             "kind = \"viscous_friction\"\naxis = 2\ncoefficient = 0.01\n";
  EXPECT_EQ(play(scenario), 0);
  return log;
}

TEST(Probe, EveryMotionRunsOnTheArmAndIsReadByTheDiagnosis) {
  const TemporaryFolder folder;
  for (const ProbeMotion& motion : probe_motions()) {
    const fs::path log = record(folder, std::string{motion.name}, 2.0);
    const std::vector<fs::path> files{log};
    const std::vector<DiagnosisCase> cases = read_log_cases(files);
    ASSERT_EQ(cases.size(), 1U) << motion.name;
    EXPECT_EQ(cases[0].plant, "phantom-1.5");
    ASSERT_EQ(cases[0].runs.size(), 1U) << motion.name;
    EXPECT_GE(cases[0].runs[0].rows(), 1999U) << motion.name;
  }
}

TEST(Probe, WritesOverNothing) {
  const TemporaryFolder folder;
  const fs::path log = record(folder, "fast_sweep", 0.6);
  const std::string before = text_of(log);
  EXPECT_THROW((void)play(folder.path() / "fast_sweep.toml"), ConfigError);
  EXPECT_EQ(text_of(log), before);
}

TEST(Diagnose, OfARecordedProbeWritesAnswerReportAndAnExperimentThatRuns) {
  const TemporaryFolder folder;
  DiagnoseOptions options{
      .cases = {record(folder, "fast_sweep", 3.0), record(folder, "hands_off", 3.0)}};
  options.json = folder.path() / "answer.json";
  options.report = folder.path() / "report.html";
  options.next = folder.path() / "next.toml";
  EXPECT_EQ(run_diagnose(options), 0);
  const auto answer = nlohmann::json::parse(text_of(options.json));
  ASSERT_EQ(answer["effects"].size(), 1U);
  EXPECT_EQ(answer["effects"][0]["kind"], "viscous_friction");
  EXPECT_EQ(answer["effects"][0]["axis"], 2);
  EXPECT_NE(text_of(options.report).find("viscous friction."), std::string::npos);
  const Scenario scenario{read_scenario(options.next.string())};
  EXPECT_EQ(scenario.kind().name, "probe");
  ASSERT_EQ(scenario.plant().effects.size(), 1U);
  EXPECT_EQ(play(options.next, {"run.seconds=1"}), 0);
  EXPECT_TRUE(fs::exists(folder.path() / "next.mcap"));
}

TEST(Diagnose, StoppedByCtrlCKeepsWhatIsKnown) {
  const TemporaryFolder folder;
  DiagnoseOptions options{.cases = {record(folder, "fast_sweep", 2.0)}};
  options.json_dir = folder.path() / "answers";
  options.report_dir = folder.path() / "reports";
  const StopSignal blocked;  // so that the signal waits for whoever listens
  ASSERT_EQ(std::raise(SIGINT), 0);
  EXPECT_EQ(run_diagnose(options), 1);
  const auto answer = nlohmann::json::parse(text_of(options.json_dir / "slave.json"));
  EXPECT_TRUE(answer["mismatch"]["where"].get<std::string>().starts_with("unfinished"));
  EXPECT_NE(text_of(options.report_dir / "index.html").find("slave.html"), std::string::npos);
}

TEST(Diagnose, RefusesFilesThatCannotBeWrittenBeforeItComputes) {
  const TemporaryFolder folder;
  DiagnoseOptions options{.cases = {record(folder, "fast_sweep", 0.6)}};
  options.report = folder.path() / "none" / "report.html";
  EXPECT_THROW((void)run_diagnose(options), ConfigError);
  options.report = folder.path();
  EXPECT_THROW((void)run_diagnose(options), ConfigError);
  options.report = folder.path() / "report.html";
  options.cases.push_back(folder.path() / "nowhere");
  EXPECT_THROW((void)run_diagnose(options), ConfigError);
  EXPECT_FALSE(fs::exists(folder.path() / "report.html"));
}

}  // namespace
}  // namespace teleop
