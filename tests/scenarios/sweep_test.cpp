#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/child.hpp"
#include "scenarios/run.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using testing::run;
using testing::TemporaryFolder;

/// 120 points of some 10 ms each.
const std::string kSweep =
    "experiment = \"virtual_wall\"\nseed = 5\n[run]\nseconds = 6.0\n[sweep]\n"
    "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\nfrom = 100\nto = 3000\npoints = 30\n"
    "[[sweep.axis]]\nkey = \"run.damping_Ns_per_m\"\nfrom = 0\nto = 9\npoints = 4\n";

std::string contents(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string tables(const fs::path& folder) {
  return contents(folder / "results.jsonl") + contents(folder / "results.csv");
}

std::vector<std::string> whole_lines(const fs::path& file) {
  const std::string text = contents(file);
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    lines.push_back(text.substr(begin, end - begin));
  }
  return lines;
}

TEST(SweepProcess, KilledInTheMiddleLosesNoFinishedPointAndRepeatsNone) {
  const TemporaryFolder folder;
  const std::string file = folder.write("wall.toml", kSweep).string();
  const std::string killed = (folder.path() / "killed").string();
  const fs::path results = folder.path() / "killed" / "results.jsonl";
  {
    Child child{"sweep", {sibling_program("teleop"), "sweep", file, "--out", killed}};
    while (!child.exit_code() && whole_lines(results).size() < 20) {
      (void)child.next_line(5);
    }
    kill(child.id(), SIGKILL);
    EXPECT_EQ(child.end(5000), 128 + SIGKILL) << "it was done before it could be killed";
  }
  std::vector<std::string> before = whole_lines(results);
  ASSERT_GE(before.size(), 20U);
  ASSERT_LT(before.size(), 120U);

  const std::string summary = (folder.path() / "summary.json").string();
  const Finished again = run("teleop sweep " + file + " --out " + killed + " --json " + summary);
  ASSERT_EQ(again.exit_code, 0) << again.output;
  const auto json = nlohmann::json::parse(contents(summary));
  EXPECT_EQ(json.at("finished"), 120);
  EXPECT_EQ(json.at("ran").get<std::size_t>(), 120 - before.size());
  std::vector<std::string> after = whole_lines(results);
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));

  const std::string whole = (folder.path() / "whole").string();
  ASSERT_EQ(run("teleop sweep " + file + " --jobs 1 --out " + whole).exit_code, 0);
  EXPECT_EQ(tables(killed), tables(whole));
  EXPECT_TRUE(fs::exists(folder.path() / "whole" / "depth_mm.png"));
}

TEST(SweepProcess, ShardsAndMergeGiveByteIdenticalTables) {
  const TemporaryFolder folder;
  const std::string file = folder.write("wall.toml", kSweep).string();
  const std::string out = folder.path().string();
  ASSERT_EQ(run("teleop sweep " + file + " --out " + out + "/whole").exit_code, 0);
  for (const char* i : {"1", "3"}) {
    const Finished shard =
        run("teleop sweep " + file + " --shard " + i + "/3 --out " + out + "/shard-" + i);
    ASSERT_EQ(shard.exit_code, 0) << shard.output;
  }
  const Finished early =
      run("teleop sweep merge " + out + "/shard-1 " + out + "/shard-3 --out " + out + "/early");
  EXPECT_EQ(early.exit_code, 2);
  EXPECT_NE(early.output.find("40 points are in none"), std::string::npos) << early.output;

  ASSERT_EQ(run("teleop sweep " + file + " --shard 2/3 --out " + out + "/shard-2").exit_code, 0);
  const Finished merged = run("teleop sweep merge " + out + "/shard-1 " + out + "/shard-2 " + out +
                              "/shard-3 --out " + out + "/merged");
  ASSERT_EQ(merged.exit_code, 0) << merged.output;
  EXPECT_EQ(tables(out + "/merged"), tables(out + "/whole"));
}

TEST(SweepProcess, RefusesAFolderWhoseFileHasChanged) {
  const TemporaryFolder folder;
  const std::string small =
      "experiment = \"virtual_wall\"\n[run]\nseconds = 1.0\n[sweep]\n"
      "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\nvalues = [500, 600]\n";
  const std::string file = folder.write("wall.toml", small).string();
  const std::string out = " --out " + (folder.path() / "out").string();
  ASSERT_EQ(run("teleop sweep " + file + out).exit_code, 0);
  const std::string before = tables(folder.path() / "out");
  (void)folder.write("wall.toml", small + "# another\n");
  const Finished refused = run("teleop sweep " + file + out);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.output.find("another sweep"), std::string::npos) << refused.output;
  EXPECT_EQ(tables(folder.path() / "out"), before);
}

TEST(RunProcess, ListsTheCatalogueRunsByNameAndDraws) {
  const TemporaryFolder folder;
  const Finished list = run("teleop run");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.output.find("computed-torque"), std::string::npos) << list.output;

  const std::string json = (folder.path() / "r.json").string();
  const Finished ran = run("teleop run computed-torque --set run.seconds=1.5 --json " + json +
                           " --out " + (folder.path() / "out").string());
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_GT(nlohmann::json::parse(contents(json)).at("results").at("pd_over_computed_torque"), 5.0);
  EXPECT_GT(fs::file_size(folder.path() / "out" / "tracking.png"), 1000U);
}

TEST(RunProcess, BadCommandsAreOneLineAndExitCode2) {
  const TemporaryFolder folder;
  const std::string bad = folder.write("bad.toml", "experiment = \"gravity\"\n[run]\nfoo = 1\n");
  const std::vector<std::pair<std::string, std::string>> table{
      {"teleop run no-such-scenario", "no-such-scenario"},
      {"teleop run " + bad, "bad.toml:3"},
      {"teleop run wall --set run.seconds", "KEY=VALUE"},
      {"teleop run wall --set run.secnds=3", "did you mean 'run.seconds'"},
      {"teleop run gravity --set device=teapot", "teapot"},
      {"teleop run wall --set device=sim:phantom-1.5", "simulated arms alone"},
      {"teleop sweep wall --out " + (folder.path() / "x").string(), "no [sweep] table"},
      {"teleop sweep coupling-stiffness --shard 3/2", "--shard 3/2"},
      {"teleop sweep", "say what to sweep"},
      {"teleop sweep merge /nowhere --out " + (folder.path() / "y").string(), "/nowhere"},
  };
  for (const auto& [command, name] : table) {
    const Finished finished = run(command);
    EXPECT_EQ(finished.exit_code, 2) << command << "\n" << finished.output;
    EXPECT_EQ(std::count(finished.output.begin(), finished.output.end(), '\n'), 1)
        << command << "\n"
        << finished.output;
    EXPECT_NE(finished.output.find(name), std::string::npos) << command << "\n" << finished.output;
  }
  EXPECT_FALSE(fs::exists(folder.path() / "x"));
}

TEST(ConfirmStart, IsNotAskedForASimulatedArmAndNotSkippedForARealOne) {
  ArmInfo real;
  real.name = "serial 7";
  ArmInfo simulated;
  simulated.simulated = true;
  EXPECT_NO_THROW(confirm_start(simulated, "x", false, false));
  EXPECT_NO_THROW(confirm_start(real, "x", true, true));
  EXPECT_THROW(confirm_start(real, "x", true, false), ConfigError);
}

}  // namespace
}  // namespace teleop
