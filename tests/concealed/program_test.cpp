#include <cstddef>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "scenarios/concealed/seal.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

TEST(ConcealProgram, WritesRecordingsPrintsTheSealAndKeepsTheTruthToItself) {
  const testing::TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  const testing::Finished done =
      testing::run("teleop_conceal --nulls 3 --seed 21 --shard 2/3 --out " + out);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  const std::string seal =
      concealed::seal({.cases = 3, .nulls = true, .seed = 21, .shard = 1, .shards = 3});
  EXPECT_NE(done.output.find(seal), std::string::npos);
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator{out}) {
    if (entry.is_directory()) continue;
    ++files;
    EXPECT_NE(entry.path().filename(), "truth.json");
    EXPECT_NE(entry.path().filename(), "run-06.csv");
    EXPECT_EQ(entry.path().parent_path().filename(), "case-0002");
  }
  EXPECT_EQ(files, 6U);
}

TEST(ConcealProgram, RefusesAShardThatIsNone) {
  const testing::Finished done =
      testing::run("teleop_conceal --cases 3 --shard 4/3 --out /nowhere");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_NE(done.output.find("i/N"), std::string::npos) << done.output;
}

}  // namespace
}  // namespace teleop
