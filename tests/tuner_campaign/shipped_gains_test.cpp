/// The tuner over the workspace: minutes, so under a label of its own.

#include "tests/tuner/shipped_gains.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::WorstPose;

TEST(ShippedGainsCampaign, TheTunerFindsNoWorsePoseThanTheRecordedOne) {
  const testing::TemporaryFolder folder;
  TuneOptions options = testing::shipped_pair();
  options.points = testing::kGridPoses;
  options.out = folder.path().string();
  (void)run_tune(options);
  std::ifstream in{folder.path() / "tune.json"};
  const nlohmann::json json = nlohmann::json::parse(in);
  const double recorded = WorstPose{}.gain_N_per_m;
  int unanswered = 0;
  for (const nlohmann::json& point : json.at("points")) {
    if (point.at("gain").is_null()) {
      // Where both have an answer the tuner's is within 15 % of theory.
      ++unanswered;
      EXPECT_GT(point.at("analytic_gain").get<double>(), 1.2 * recorded) << point.at("pose_rad");
      continue;
    }
    EXPECT_GE(point.at("gain_high").get<double>(), recorded)
        << point.at("axis") << " at " << point.at("pose_rad");
  }
  RecordProperty("worst", json.at("worst").dump());
  EXPECT_LE(unanswered, options.points * 3 / 20);
}

}  // namespace
}  // namespace teleop
