#include "scenarios/scoring/rates.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "scenarios/scoring/rate_table.hpp"

namespace teleop {
namespace {

TEST(Rate, HasTheBoundsOfClopperAndPearson) {
  // None of n: 1 − 0.05^(1/n). By tables: 1 of 10 is below 39.4 %, 9 of 10 above 60.6 %.
  EXPECT_NEAR((Rate{0, 300}.upper95()), 1.0 - std::pow(0.05, 1.0 / 300.0), 1e-9);
  EXPECT_NEAR((Rate{1, 10}.upper95()), 0.3942, 1e-4);
  EXPECT_NEAR((Rate{9, 10}.lower95()), 0.6058, 1e-4);
  EXPECT_EQ((Rate{10, 10}.upper95()), 1.0);
  EXPECT_EQ((Rate{0, 0}.upper95()), 1.0);
  EXPECT_EQ((Rate{0, 0}.lower95()), 0.0);
}

TEST(Spread, InterpolatesBetweenTheValues) {
  const Spread spread = spread_of({4.0, 1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(spread.median, 2.5);
  EXPECT_DOUBLE_EQ(spread.p90, 3.7);
  EXPECT_EQ(spread_of({}).n, 0U);
}

TEST(Calibration, IsNoughtForHonestConfidencesAndLargeForBoasts) {
  std::vector<CaseScore::Claim> honest;
  std::vector<CaseScore::Claim> boasts;
  for (int i = 0; i < 10; ++i) {
    honest.push_back({.confidence = 0.8, .holds = i < 8});
    boasts.push_back({.confidence = 1.0, .holds = i < 2});
  }
  EXPECT_NEAR(calibration_of(honest).ece, 0.0, 1e-12);
  EXPECT_NEAR(calibration_of(boasts).ece, 0.8, 1e-12);
  EXPECT_NEAR(calibration_of(boasts).brier, 0.8, 1e-12);
}

CaseScore single(double dnr, bool right) {
  return {
      .content = Content::one, .group = "single", .kind = "payload", .dnr = dnr, .right = right};
}

TEST(Rates, SortSingleEffectsByWhatTheyDoToTheRunHeldBack) {
  const Rates rates = rates_of({{.score = single(0.5, true)},
                                {.score = single(0.1, false)},
                                {.score = single(0.05, true)},
                                {.score = single(0.0, false)}});
  EXPECT_EQ(rates.bands[0].right.n, 2U);
  EXPECT_EQ(rates.bands[0].right.k, 1U);
  EXPECT_EQ(rates.bands[1].right.n, 1U);
  EXPECT_EQ(rates.bands[2].right.n, 1U);
  EXPECT_EQ(rates.by_kind.at("payload").n, 3U);
}

TEST(Rates, CountNastyCasesByWhatTheyHoldAndOnceMoreByTheirSort) {
  CaseScore nothing{.content = Content::nothing, .group = "nasty", .sort = "foreign_integrator"};
  nothing.detected = true;
  CaseScore stranger{.content = Content::stranger, .group = "nasty", .sort = "catch"};
  stranger.flagged = true;
  const Rates rates = rates_of({{.score = nothing}, {.score = stranger}});
  EXPECT_EQ(rates.false_discoveries.k, 1U);
  EXPECT_EQ(rates.flagged.k, 1U);
  EXPECT_EQ(rates.nasty.at("foreign_integrator").k, 0U);
  EXPECT_EQ(rates.nasty.at("catch").k, 1U);
}

TEST(RateTable, IsMarkdownWithOneLineARowAndLeavesOutWhatNobodyWasAsked) {
  const Rates rates = rates_of({{.score = single(0.5, true)}});
  const auto tables = tables_of({{"ours", rates}, {"peer", rates}});
  const std::string text = text_of(tables.front(), TableStyle::markdown);
  EXPECT_NE(text.find("| figure"), std::string::npos);
  EXPECT_NE(text.find("1/1, 100.0 %"), std::string::npos);
  EXPECT_EQ(text.find("two effects"), std::string::npos);
}

}  // namespace
}  // namespace teleop
