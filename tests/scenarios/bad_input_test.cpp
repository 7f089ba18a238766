#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::Finished;
using testing::run;
using testing::TemporaryFolder;

/// A command that cannot work, and what its one line must name.
struct Bad {
  std::string command;
  std::vector<std::string> names;
};

void expect_one_clear_line(const Bad& bad) {
  const Finished finished = run(bad.command);

  EXPECT_EQ(finished.exit_code, 2) << bad.command << "\n" << finished.output;
  EXPECT_EQ(std::count(finished.output.begin(), finished.output.end(), '\n'), 1)
      << bad.command << "\n"
      << finished.output;
  for (const std::string& name : bad.names) {
    EXPECT_NE(finished.output.find(name), std::string::npos)
        << bad.command << "\nnames not '" << name << "'\n"
        << finished.output;
  }
}

TEST(BadInput, OnTheCommandLineIsOneLineAndExitCode2) {
  const std::vector<Bad> commands{
      {"teleop", {"say what to do"}},
      {"teleop lopback", {"lopback"}},
      {"teleop loopback --seconds -1", {"seconds"}},
      {"teleop loopback --environment mud", {"environment", "mud"}},
      {"teleop-master --no-such-option 1", {"no-such-option"}},
      {"teleop-master --config no-such-file.toml", {"no-such-file.toml", "no such file"}},
      {"teleop-master --law.stiffness_slave_N_per_m -5",
       {"law.stiffness_slave_N_per_m", "-5", "0 or more"}},
      {"teleop-master --loop.rate_Hz 50", {"loop.rate_Hz", "100"}},
      {"teleop-master --device teapot", {"teapot", "sim"}},
      {"teleop-master --device sim:no-such-plant.toml", {"no-such-plant.toml"}},
      {"teleop-master --hand no-such-trace.csv", {"no-such-trace.csv"}},
      {"teleop-slave --environment mud", {"mud"}},
      {"teleop-master --link.peer nowhere", {"nowhere"}},
      {"teleop export no-such.mcap --csv x.csv", {"no-such.mcap"}},
      {"teleop report no-such.mcap", {"no-such.mcap"}},
      {"teleop recover no-such.mcap", {"no-such.mcap"}},
      {"teleop workspace --arm no-such-arm", {"no-such-arm"}},
      {"teleop blind --shard 4/3", {"shard", "4/3"}},
      {"teleop blind --cases 3 --nulls 3", {"nulls", "cases"}},
      {"teleop blind --json no-such-folder/x.json", {"no-such-folder"}},
      {"teleop blind merge no-such-campaign --out x", {"no-such-campaign"}},
      {"teleop frequency-response --axis w", {"axis", "w"}},
      {"teleop frequency-response --rate-Hz 20000", {"rate", "10000"}},
      {"teleop frequency-response --rate-Hz 1000 --high-Hz 450", {"400", "rate"}},
      {"teleop frequency-response --low-Hz 1", {"lowest", "2"}},
      {"teleop frequency-response --device teapot", {"teapot"}},
      {"teleop velocity no-such.mcap", {"no-such.mcap"}},
      {"teleop velocity --set velocity.period.samples=7", {"period.samples", "multiple of 4"}},
      {"teleop-master --velocity.kind guess", {"guess", "adaptive_window"}},
  };
  for (const Bad& bad : commands)
    expect_one_clear_line(bad);
}

TEST(BadInput, InAFileNamesFileAndLine) {
  const TemporaryFolder folder;
  const std::string config = folder.write("pair.toml", "[law]\nstifness_slave_N_per_m = 100\n");
  const std::string nan = folder.write("nan.csv", "t_s,q_rad\n0.0,0.0\n0.001,nan\n0.002,0.0\n");
  const std::string backwards =
      folder.write("back.csv", "t_s,q_rad\n0.0,0.0\n0.002,0.1\n0.001,0.0\n");
  const std::string columns = folder.write("columns.csv", "time,angle\n0.0,0.0\n0.1,0.0\n");
  const std::string plant =
      folder.write("plant.toml", "arm = \"phantom-1.5\"\n[[effect]]\nkind = \"magic\"\naxis = 1\n");
  const std::string torn = folder.write("torn.mcap", "\x89MCAP0\r\nnot really");
  const std::vector<Bad> commands{
      {"teleop-master --config " + config,
       {"pair.toml:2", "stifness_slave_N_per_m", "did you mean"}},
      {"teleop-master --hand " + nan, {"nan.csv:3"}},
      {"teleop-master --hand " + backwards, {"back.csv:4"}},
      {"teleop-master --hand " + columns, {"columns.csv"}},
      {"teleop-master --device sim:" + plant, {"plant.toml:", "magic"}},
      {"teleop export " + torn + " --csv " + (folder.path() / "x.csv").string(), {"torn.mcap"}},
      {"teleop report " + torn, {"torn.mcap"}},
      {"teleop loopback --seconds 1 --out /proc/nowhere", {"/proc/nowhere"}},
      {"teleop loopback --seconds 1 --json /proc/nowhere/s.json --out " +
           (folder.path() / "o").string(),
       {"/proc/nowhere/s.json"}},
  };
  for (const Bad& bad : commands)
    expect_one_clear_line(bad);
}

TEST(BadInput, NeverWritesOverAnything) {
  const TemporaryFolder folder;
  const auto recording = folder.write("master.mcap", "precious");

  expect_one_clear_line(
      {"teleop loopback --seconds 1 --out " + folder.path().string(), {"master.mcap", "exists"}});
  expect_one_clear_line(
      {"teleop-master --out " + folder.path().string(), {"master.mcap", "exists"}});

  std::string text;
  std::ifstream{recording} >> text;
  EXPECT_EQ(text, "precious");
}

TEST(BadInput, AnAddressOfAnotherMachineIsNamed) {
  const TemporaryFolder folder;
  expect_one_clear_line({"teleop-slave --link.bind 192.0.2.1:47001", {"192.0.2.1"}});
}

TEST(Help, NamesEverySettingAndPrintsItsConfigurationAsReadableToml) {
  const Finished help = run("teleop-master --help");
  EXPECT_EQ(help.exit_code, 0);
  const Finished printed = run("teleop-master --print-config --law.scale 2");
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_NE(printed.output.find("command line"), std::string::npos);

  const TemporaryFolder folder;
  const auto file = folder.write("printed.toml", printed.output);
  const Finished again = run("teleop-master --print-config --config " + file.string());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_NE(again.output.find("scale = 2.0"), std::string::npos) << again.output;

  for (const char* key : {"device", "loop.rate_Hz", "law.scale", "link.peer", "out"}) {
    EXPECT_NE(help.output.find(std::string{"--"} + key), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace teleop
