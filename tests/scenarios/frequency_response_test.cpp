#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using nlohmann::json;

TEST(FrequencyResponseVerb, WritesLinesFitsAndPictureOfTheSimulatedArm) {
  const testing::TemporaryFolder folder;
  const std::string file = (folder.path() / "z.json").string();
  const testing::Finished finished = testing::run(
      "teleop frequency-response --device sim:phantom-1.5-bare --axis z --rate-Hz 2000 "
      "--realisations 3 --out " +
      folder.path().string() + " --json " + file);
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_NE(finished.output.find("will move along z"), std::string::npos) << finished.output;
  for (const char* name : {"frequency-response-z.png", "frequency-response-z.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  }

  std::ifstream stream{file};
  const json result = json::parse(stream);
  EXPECT_EQ(result.at("axis"), "z");
  for (const json& line : result.at("lines")) {
    for (const char* key : {"f_Hz", "gain", "phase_rad", "coherence", "distortion"}) {
      EXPECT_TRUE(line.at(key).is_number()) << key;
    }
  }
  ASSERT_EQ(result.at("fits").size(), 4U);
  const json& form_a = result.at("fits").at(0);
  EXPECT_EQ(form_a.at("form"), "a");
  EXPECT_EQ(form_a.at("passive"), true);
  const json& m1 = form_a.at("parameters").at(0);
  EXPECT_EQ(m1.at("name"), "m1");
  EXPECT_NEAR(m1.at("value").get<double>(), 32.2e-3, 1e-3);  // the rigid arm at home
}

}  // namespace
}  // namespace teleop
