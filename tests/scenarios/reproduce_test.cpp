#include "scenarios/reproduce.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "scenarios/paper_experiments.hpp"

namespace teleop {
namespace {

TEST(Reproduce, ComesWithinATenthOfEveryRowThatItClaims) {
  const PaperSet set = declared_paper_set();
  for (const PaperRowId row :
       {PaperRowId::wall_linear, PaperRowId::wall_stock, PaperRowId::damping_100,
        PaperRowId::damping_16, PaperRowId::heat_linear, PaperRowId::heat_pwm}) {
    const double ours = *analysed(row, set);
    EXPECT_NEAR(ours / text_of(row).paper, 1.0, 0.10) << text_of(row).id;
  }
}

TEST(Reproduce, CallsNothingPredictedWhoseTargetChoseAParameter) {
  PaperSet set = declared_paper_set();
  const double paper = text_of(PaperRowId::damping_16).paper;
  EXPECT_EQ(status_of(PaperRowId::damping_16, paper, set), "predicted");
  set.parameters[PaperSet::damping].fitted_to.emplace_back("damping_16");
  EXPECT_EQ(status_of(PaperRowId::damping_16, paper, set), "fitted");
  EXPECT_EQ(status_of(PaperRowId::damping_16, 1.11 * paper, set), "not_reproduced");
  for (const PaperParameter& parameter : set.parameters) {
    EXPECT_GE(parameter.value, parameter.low) << parameter.name;
    EXPECT_LE(parameter.value, parameter.high) << parameter.name;
    EXPECT_FALSE(parameter.source.empty()) << parameter.name;
  }
}

TEST(Reproduce, FindsTheDampingOfTheHundredSamplesByExperiment) {
  const PaperRow row =
      do_experiment(PaperRowId::damping_100, declared_paper_set(), StockDrive::lag);
  const double analysis = *analysed(PaperRowId::damping_100, declared_paper_set());
  EXPECT_NEAR(row.ours / analysis, 1.0, 0.02) << row.note;
  EXPECT_LT(row.low, row.ours);
  EXPECT_GT(row.high, row.ours);
}

TEST(Reproduce, HeatsByTheDutyWhereTheCurrentSettlesAndNotWhereItIsSmooth) {
  PaperSet set = declared_paper_set();
  set.parameters[PaperSet::copper].value = 0.0;  // a voltage drive weakens as it warms
  const double linear = casing_rise(set, false);
  set.parameters[PaperSet::carrier].value = 200e3;
  EXPECT_NEAR(casing_rise(set, true) / linear, 1.0, 0.01);
  set.parameters[PaperSet::carrier].value = 20.0;
  EXPECT_NEAR(casing_rise(set, true) / linear, 8.5 / 2.0, 0.05);
}

TEST(Reproduce, MeasuresGranularityAndLagAsThePaperStatesThem) {
  const PaperSet set = declared_paper_set();
  EXPECT_NEAR(do_experiment(PaperRowId::velocity_granularity, set, StockDrive::lag).ours, 30.0,
              1.0);
  EXPECT_NEAR(do_experiment(PaperRowId::velocity_lag, set, StockDrive::lag).ours, 50.0, 0.01);
}

}  // namespace
}  // namespace teleop
