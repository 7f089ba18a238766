#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scenarios/concealed/concealed_case.hpp"
#include "scenarios/concealed/seal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop::concealed {
namespace {

std::size_t sampled_cases(std::size_t usual) {
  const char* const wanted = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return wanted == nullptr ? usual : static_cast<std::size_t>(std::strtoul(wanted, nullptr, 10));
}

std::map<std::string, std::size_t> groups(const std::vector<Slot>& slots) {
  std::map<std::string, std::size_t> result;
  for (const Slot& slot : slots) {
    ++result[std::string{name_of(slot.group)}];
  }
  return result;
}

TEST(ConcealedPlan, HasThePromisedComposition) {
  for (const std::uint64_t seed : {3U, 91U}) {
    const std::vector<Slot> slots = lay_out({.cases = 200, .seed = seed});
    const auto count = groups(slots);
    EXPECT_EQ(count.at("single"), 100U);
    EXPECT_EQ(count.at("pair"), 30U);
    EXPECT_EQ(count.at("out_of_vocabulary"), 30U);
    EXPECT_EQ(count.at("nasty"), 40U);
    std::map<std::string, int> kinds;
    std::map<Band, int> bands;
    std::set<std::string> nasty;
    std::map<std::string, int> strange;
    for (const Slot& slot : slots) {
      if (slot.group == Group::single) ++kinds[slot.sort];
      if (slot.group == Group::single) ++bands[slot.band];
      if (slot.group == Group::nasty) nasty.insert(slot.sort);
      if (slot.group == Group::out_of_vocabulary) ++strange[slot.sort];
    }
    EXPECT_EQ(kinds.size(), vocabulary().size());
    for (const auto& [kind, number] : kinds) {
      EXPECT_EQ(number, 4) << kind;
    }
    for (const Band band : {Band::obvious, Band::visible, Band::faint}) {
      EXPECT_GE(bands[band], 25);
    }
    EXPECT_EQ(nasty.size(), nasty_sorts().size());
    EXPECT_GE(strange.size(), 8U);
  }
}

TEST(ConcealedPlan, KeepsItsProportionsForAnyNumber) {
  for (std::size_t cases = 1; cases < 60; ++cases) {
    const auto slots = lay_out({.cases = cases, .seed = 5});
    ASSERT_EQ(slots.size(), cases);
    const auto count = groups(slots);
    for (const auto& [group, share] : std::map<std::string, double>{
             {"single", 0.5}, {"pair", 0.15}, {"out_of_vocabulary", 0.15}, {"nasty", 0.2}}) {
      const double number = count.contains(group) ? static_cast<double>(count.at(group)) : 0.0;
      EXPECT_NEAR(number, share * static_cast<double>(cases), 1.0) << group << " of " << cases;
    }
  }
}

TEST(ConcealedPlan, OfNullsHasEverySortEquallyOften) {
  std::map<std::string, int> sorts;
  for (const Slot& slot : lay_out({.cases = 110, .nulls = true, .seed = 5})) {
    ASSERT_EQ(slot.group, Group::null);
    ++sorts[slot.sort];
  }
  EXPECT_EQ(sorts.size(), null_sorts().size());
  for (const auto& [sort, number] : sorts) {
    EXPECT_EQ(number, 10) << sort;
  }
}

TEST(ConcealedCase, IsDecidedBySeedAndIndexAlone) {
  const ConcealedPlan plan{.cases = 40, .seed = 8};
  const ConcealedCase once = draw_case(plan, 11);
  static_cast<void>(draw_case(plan, 3));
  const ConcealedCase again = draw_case(plan, 11);
  EXPECT_EQ(truth_json(once), truth_json(again));
  for (std::size_t k = 0; k < kRuns; ++k) {
    EXPECT_EQ(once.runs[k].counts, again.runs[k].counts);
    EXPECT_EQ(once.runs[k].logged, again.runs[k].logged);
  }
  EXPECT_NE(truth_json(once), truth_json(draw_case({.cases = 40, .seed = 9}, 11)));
}

TEST(ConcealedCase, SinglesComeOutInTheirBandAndStayInTheWorkspace) {
  const ConcealedPlan plan{.cases = 200, .seed = 31};
  const std::vector<Slot> slots = lay_out(plan);
  std::size_t left = sampled_cases(3);
  for (std::size_t index = 0; index < slots.size() && left > 0; ++index) {
    if (slots[index].group != Group::single) continue;
    --left;
    const ConcealedCase drawn = draw_case(plan, index);
    SCOPED_TRACE(drawn.slot.sort);
    EXPECT_EQ(name_of(band_of(drawn.dnr)), name_of(drawn.slot.band));
    ASSERT_EQ(drawn.device.effects.size(), 1U);
    EXPECT_EQ(drawn.device.effects[0].kind, drawn.slot.sort);
    Device calm = drawn.device;
    calm.effects.clear();
    for (std::size_t k = 0; k < kRuns; ++k) {
      EXPECT_TRUE(drawn.runs[k].usable(simulate(calm, k, 8)));
    }
  }
}

TEST(ConcealedCase, NullsHoldNothingAndHaveNothingToDetect) {
  const ConcealedPlan plan{.cases = null_sorts().size(), .nulls = true, .seed = 4};
  for (std::size_t index = 0; index < sampled_cases(3) && index < plan.cases; ++index) {
    const ConcealedCase drawn = draw_case(plan, index);
    EXPECT_TRUE(drawn.device.effects.empty());
    EXPECT_EQ(drawn.dnr, 0.0);
    const auto truth = nlohmann::json::parse(truth_json(drawn));
    EXPECT_EQ(truth.at("channels"), nlohmann::json::array({"none"}));
    EXPECT_EQ(truth.at("class"), "null");
  }
}

std::vector<double> numbers(const std::string& line) {
  std::vector<double> result;
  std::istringstream cells{line};
  for (std::string cell; std::getline(cells, cell, ',');) {
    result.push_back(std::strtod(cell.c_str(), nullptr));
  }
  return result;
}

TEST(ConcealedCase, FilesHoldWhatTheFormatSaysAndNoTruth) {
  const ConcealedCase drawn = draw_case({.cases = 20, .seed = 12}, 0);
  const teleop::testing::TemporaryFolder folder;
  write_case(drawn, folder.path());
  const auto place = folder.path() / drawn.name;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{place}) {
    ++files;
    EXPECT_NE(entry.path().filename(), "truth.json");
    EXPECT_NE(entry.path().filename(), "run-06.csv");
  }
  EXPECT_EQ(files, 6U);
  const JointVector count = count_rad(drawn.device.nominal);
  std::ifstream run{place / "run-03.csv"};
  std::string line;
  std::getline(run, line);
  EXPECT_EQ(line, "t_s,tau1_Nm,tau2_Nm,tau3_Nm,q1_rad,q2_rad,q3_rad");
  std::size_t row = 0;
  for (; std::getline(run, line); ++row) {
    const std::vector<double> cells = numbers(line);
    ASSERT_EQ(cells.size(), 7U);
    ASSERT_NEAR(cells[0], 1e-3 * static_cast<double>(row), 1e-9);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      ASSERT_NEAR(cells[1 + i], drawn.runs[2].logged[row][k], 1e-9);
      ASSERT_NEAR(std::remainder(cells[1 + i], kCommandStep_Nm), 0.0, 1e-12);
      ASSERT_NEAR(cells[4 + i] / count[k], drawn.runs[2].counts[row][i], 1e-3);
    }
  }
  EXPECT_EQ(row, kRows);

  write_truth(drawn, folder.path());
  EXPECT_TRUE(std::filesystem::exists(place / "truth.json"));
  EXPECT_TRUE(std::filesystem::exists(place / "run-06.csv"));
}

TEST(ConcealedCase, EffectsOfTrainingRunsAreNotInTheRunHeldBack) {
  const ArmModel arm = load_arm("phantom-1.5");
  Device device{.arm = arm, .nominal = arm};
  device.effects = {
      {.kind = "torque_gain", .axis = 1, .parameters = {{"gain", 0.5}}, .training_only = true}};
  EXPECT_EQ(law_of(device, 0).axes[1].actuation.gain, 0.5);
  EXPECT_EQ(law_of(device, kRuns - 1).axes[1].actuation.gain, 1.0);
}

TEST(Seal, IsTheSha256OfTheTruth) {
  Seal empty;
  EXPECT_EQ(empty.digits(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Seal parts;
  parts.add("a");
  parts.add("bc");
  EXPECT_EQ(parts.digits(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const ConcealedPlan plan{.cases = 8, .nulls = true, .seed = 4, .shard = 1, .shards = 8};
  Seal by_hand;
  by_hand.add(truth_json(draw_case(plan, 1)));
  EXPECT_EQ(seal(plan), by_hand.digits());
}

}  // namespace
}  // namespace teleop::concealed
