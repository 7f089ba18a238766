#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::run;
using testing::TemporaryFolder;

constexpr int kSkip = 77;

const std::string kSweep =
    "experiment = \"virtual_wall\"\nseed = 5\n[run]\nseconds = 1.0\n[sweep]\n"
    "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\nfrom = 100\nto = 3000\npoints = 14\n";

std::string contents(const std::string& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Finished {
  int exit_code = -1;
  std::string output;
};

Finished shell(const std::string& command) {
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  Finished finished;
  std::array<char, 4096> block{};
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
    finished.output.append(block.data(), n);
  }
  const int status = pclose(pipe);
  finished.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return finished;
}

TEST(SweepOnSlurm, AnArrayOfShardsAndTheirMergeGiveTheBytesOfOneRun) {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  const std::string file = folder.write("wall.toml", kSweep).string();
  const std::string source = TELEOP_SOURCE_DIR;
  const Finished array =
      shell("cd " + path + " && TELEOP=" + TELEOP_BINARY_DIR + "/teleop " + source +
            "/tests/slurm/local_slurm.sh " + path + "/slurm sbatch -W --array=1-3 " + source +
            "/scenarios/slurm/sweep.sbatch " + file + " " + path + "/out");
  if (array.exit_code == kSkip) GTEST_SKIP() << array.output;
  ASSERT_EQ(array.exit_code, 0) << array.output;

  const auto merged = run("teleop sweep merge " + path + "/out/shard-1 " + path + "/out/shard-2 " +
                          path + "/out/shard-3 --out " + path + "/all");
  ASSERT_EQ(merged.exit_code, 0) << merged.output;
  const auto whole = run("teleop sweep " + file + " --out " + path + "/whole");
  ASSERT_EQ(whole.exit_code, 0) << whole.output;
  for (const char* table : {"/results.jsonl", "/results.csv"}) {
    EXPECT_EQ(contents(path + "/all" + table), contents(path + "/whole" + table));
    EXPECT_GT(contents(path + "/all" + table).size(), 500U);
  }
}

}  // namespace
}  // namespace teleop
