#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

nlohmann::json figures_of(const std::string& campaign) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "figures.json";
  const testing::Finished done =
      testing::run("teleop blind " + campaign + " --out " + (folder.path() / "out").string() +
                   " --json " + file.string());
  EXPECT_EQ(done.exit_code, 0) << done.output;
  std::cout << done.output;
  return nlohmann::json::parse(std::ifstream{file});
}

std::string number_of_cases() {
  const char* const wanted = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return wanted == nullptr ? "20" : wanted;
}

/// A sample is too small for the rates that are aimed at; what it can show is that none of them has
/// collapsed.
TEST(BlindCampaign, OfASampleNamesMostObviousEffectsAndAnswersEveryCase) {
  const nlohmann::json figures = figures_of("--seed 11 --cases " + number_of_cases());
  EXPECT_EQ(figures.at("missing"), 0);
  const nlohmann::json& obvious = figures.at("bands").at(0);
  EXPECT_GE(obvious.at("right").get<double>(), 0.6 * obvious.at("n").get<double>());
  EXPECT_LT(figures.at("parameter_error").at("median").get<double>(), 0.1);
}

TEST(BlindCampaign, OfNullsKeepsSilentOnNearlyAll) {
  const nlohmann::json figures = figures_of("--seed 12 --nulls " + number_of_cases());
  EXPECT_EQ(figures.at("missing"), 0);
  EXPECT_LE(figures.at("nulls").at("false").get<double>(),
            0.15 * figures.at("nulls").at("n").get<double>());
}

}  // namespace
}  // namespace teleop
