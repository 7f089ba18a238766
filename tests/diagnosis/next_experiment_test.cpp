#include "core/diagnosis/next_experiment.hpp"

#include <gtest/gtest.h>

#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::make_case;
using testing::phantom;

EffectSpec effect(const char* kind, std::size_t axis, std::map<std::string, double> parameters) {
  return {.kind = kind, .axis = axis, .parameters = std::move(parameters)};
}

/// A leading effect and a rival that is near.
SearchResult tie(const EffectSpec& leading, const EffectSpec& rival) {
  SearchResult found;
  found.best.fit.model.effects = {leading};
  found.effects.push_back(
      {.effect = leading, .gain = 100.0, .rivals = {{.effect = rival, .behind = 1.0}}});
  return found;
}

NextExperiment next_of(const SearchResult& found, const std::string& left_over = "") {
  const DiagnosisCase data = make_case({.runs = 1, .seconds = 0.3});
  const Likelihood likelihood{data, phantom(), 1};
  return next_experiment(likelihood, found, left_over);
}

double evidence_of(const NextExperiment& next, std::string_view motion) {
  for (const ExpectedEvidence& each : next.motions) {
    if (each.motion->name == motion) return each.log_bayes;
  }
  return -1.0;
}

TEST(NextExperiment, TellsDryFromViscousFrictionAtTwoSpeeds) {
  const NextExperiment next = next_of(tie(effect("coulomb_friction", 1, {{"level", 0.006}}),
                                          effect("viscous_friction", 1, {{"coefficient", 0.006}})));
  EXPECT_TRUE(next.ties);
  EXPECT_EQ(next.motions.size(), probe_motions().size());
  EXPECT_GT(next.motions.front().log_bayes, 10.0);
  EXPECT_EQ(next.motions.front().rival,
            "coulomb friction on axis 2 from viscous friction on axis 2");
  EXPECT_NE(next.text.find(next.motions.front().motion->text), std::string::npos);
}

TEST(NextExperiment, TellsHeatFromAGainByRestAndRepetition) {
  const NextExperiment next =
      next_of(tie(effect("thermal_derating", 1, {{"loss", 0.05}, {"time_constant", 4.0}}),
                  effect("torque_gain", 1, {{"gain", 0.95}})));
  EXPECT_GT(evidence_of(next, "rest_repeat"), evidence_of(next, "multisine"));
  EXPECT_GT(evidence_of(next, "rest_repeat"), 3.0);
}

TEST(NextExperiment, SaysWhenNothingTellsTheRivalsApart) {
  // A level that hardly rises at rest is the same friction.
  const NextExperiment next =
      next_of(tie(effect("coulomb_friction", 0, {{"level", 0.004}}),
                  effect("stribeck_friction", 0,
                         {{"coulomb", 0.004}, {"static", 0.00401}, {"stribeck_velocity", 0.002}})));
  EXPECT_LT(next.motions.front().log_bayes, 3.0);
  EXPECT_TRUE(next.text.starts_with("none of the safe motions")) << next.text;
}

TEST(NextExperiment, OfASoleExplanationMeasuresItBetter) {
  SearchResult found = tie(effect("viscous_friction", 0, {{"coefficient", 0.004}}), {});
  found.effects.front().rivals.clear();
  const NextExperiment next = next_of(found);
  EXPECT_FALSE(next.ties);
  EXPECT_GT(next.motions.front().log_bayes, 10.0);
  EXPECT_TRUE(next.text.starts_with("no rival is near")) << next.text;
}

TEST(NextExperiment, IsNoneWhereNothingIsMissing) {
  EXPECT_TRUE(next_of({}).text.starts_with("none is needed"));
  EXPECT_TRUE(next_of({}, "direction × time").text.find("twice") != std::string::npos);
}

}  // namespace
}  // namespace teleop
