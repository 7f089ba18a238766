/// The tuner against plants whose margins are known. A small sample of the campaign that
/// `teleop bench tune` runs whole.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/bench_tune.hpp"
#include "scenarios/tune.hpp"
#include "scenarios/tune_journal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

std::size_t cases() {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return text != nullptr ? static_cast<std::size_t>(std::atoi(text)) : 40;
}

TEST(TunerCampaign, FindsTheMarginsOfRandomPlantsWithinItsIntervalsAndBounds) {
  std::size_t near = 0;
  std::size_t covered = 0;
  std::vector<double> widths;
  for (std::size_t i = 0; i < cases(); ++i) {
    const TuneCase one = random_case(2024, i);
    ASSERT_TRUE(one.margin) << i;
    const TunedCase tuned = tune_case(one);
    EXPECT_TRUE(tuned.within_bounds) << i;
    if (!tuned.point.crossing) continue;
    const Crossing& c = *tuned.point.crossing;
    if (std::abs(c.gain / one.margin->gain - 1.0) <= 0.02) ++near;
    if (c.low <= one.margin->gain && one.margin->gain <= c.high) ++covered;
    widths.push_back(c.relative_width());
  }
  const auto count = static_cast<double>(cases());
  std::sort(widths.begin(), widths.end());
  EXPECT_GE(static_cast<double>(near) / count, 0.95);
  EXPECT_GE(static_cast<double>(covered) / count, 0.75);
  EXPECT_LE(widths.at(widths.size() / 2), 0.02);
}

TEST(TunerCampaign, GivesTheSameAnswerForTheSameSeed) {
  for (const std::size_t i : {0U, 1U, 2U}) {
    const TunedCase one = tune_case(random_case(5, i));
    const TunedCase two = tune_case(random_case(5, i));
    ASSERT_TRUE(one.point.crossing && two.point.crossing);
    EXPECT_EQ(one.point.crossing->gain, two.point.crossing->gain);
    EXPECT_EQ(one.point.arm_seconds, two.point.arm_seconds);
  }
}

nlohmann::json read(const std::filesystem::path& file) {
  std::ifstream in{file};
  return nlohmann::json::parse(in);
}

TuneOptions quick(const std::filesystem::path& folder) {
  TuneOptions options;
  options.axis = "z";
  options.width_percent = 8.0;
  options.out = folder.string();
  return options;
}

TEST(TuneVerb, WritesWhatScriptsRelyOn) {
  const testing::TemporaryFolder folder;
  TuneOptions options = quick(folder.path());
  options.json = (folder.path() / "result.json").string();
  (void)run_tune(options);
  const nlohmann::json json = read(options.json);
  EXPECT_EQ(json.at("experiment"), "wall");
  EXPECT_EQ(json.at("axis"), "z");
  EXPECT_EQ(json.at("device"), "sim");
  const nlohmann::json& point = json.at("points").at(0);
  EXPECT_EQ(point.at("pose_rad").size(), 3U);
  EXPECT_LE(point.at("gain_low"), point.at("gain"));
  EXPECT_GE(point.at("gain_high"), point.at("gain"));
  EXPECT_EQ(point.at("unit"), "N/m");
  EXPECT_NEAR(point.at("gain").get<double>() / point.at("analytic_gain").get<double>(), 1.0, 0.15);
  EXPECT_GT(point.at("arm_seconds"), 0.0);
  EXPECT_EQ(point.at("stops").size(), point.at("probes").size());
  for (const nlohmann::json& probe : point.at("probes")) {
    EXPECT_TRUE(probe.at("rests").get<bool>());
    EXPECT_LE(probe.at("ticks_to_safe"), 2);
  }
  EXPECT_EQ(json.at("worst").at("gain"), point.at("gain"));
}

TEST(TuneVerb, ResumesFromItsJournalWithoutRepeatingAProbe) {
  const testing::TemporaryFolder folder;
  TuneOptions options = quick(folder.path());
  (void)run_tune(options);
  const auto journal = folder.path() / "tune.jsonl";
  const nlohmann::json whole = read(folder.path() / "tune.json");
  std::vector<std::string> lines;
  {
    std::ifstream in{journal};
    for (std::string line; std::getline(in, line);)
      lines.push_back(line);
  }
  ASSERT_GT(lines.size(), 8U);
  {
    // Killed in the middle of a line.
    std::ofstream out{journal};
    for (std::size_t i = 0; i < 7; ++i)
      out << lines[i] << '\n';
    out << lines[7].substr(0, lines[7].size() / 2);
  }
  options.resume = true;
  (void)run_tune(options);
  const nlohmann::json resumed = read(folder.path() / "tune.json");
  const nlohmann::json& before = whole.at("points").at(0).at("probes");
  const nlohmann::json& after = resumed.at("points").at(0).at("probes");
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(before.at(i), after.at(i)) << i;
  EXPECT_FALSE(resumed.at("points").at(0).at("gain").is_null());

  options.axis = "y";
  EXPECT_THROW((void)run_tune(options), ConfigError);
}

}  // namespace
}  // namespace teleop
