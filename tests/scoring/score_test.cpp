#include "scenarios/scoring/score.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/scoring/equivalence.hpp"

namespace teleop {
namespace {

using nlohmann::json;

json effect(const char* kind, const json& axis, json parameters) {
  return {{"kind", kind}, {"axis", axis}, {"parameters", std::move(parameters)}};
}

json truth_json(const char* group, const std::vector<json>& effects, double dnr = 0.2) {
  return {{"case", "case-0001"},
          {"class", group},
          {"sub", ""},
          {"effects", effects},
          {"channels", json::array({"none"})},
          {"dnr_held_out", dnr}};
}

CaseTruth truth(const char* group, const std::vector<json>& effects) {
  return read_truth(truth_json(group, effects));
}

json named(const char* kind, const json& axis, double confidence) {
  return {{"kind", kind}, {"axis", axis}, {"confidence", confidence}};
}

json with_rival(json effect, const char* kind, const json& axis, double confidence) {
  effect["alternatives"].push_back(named(kind, axis, confidence));
  return effect;
}

json answer(const char* verdict, json effects) {
  return {{"verdict", verdict},
          {"mismatch", {{"axes", json::array()}, {"channel", "none"}}},
          {"effects", std::move(effects)}};
}

CaseScore scored(const CaseTruth& of, const json& given) { return score(of, read_answer(given)); }

const CaseTruth& friction() {
  static const CaseTruth of =
      truth("single", {effect("coulomb_friction", 2, {{"level", 0.01}, {"asymmetry", 0.0}})});
  return of;
}

TEST(Score, TakesTheRightNameForRightAndAnotherAxisForWrong) {
  const CaseScore right =
      scored(friction(), answer("explained", {named("coulomb_friction", 2, 0.9)}));
  EXPECT_TRUE(right.right);
  EXPECT_FALSE(right.wrong_name);
  const CaseScore wrong =
      scored(friction(), answer("explained", {named("coulomb_friction", 3, 0.9)}));
  EXPECT_FALSE(wrong.right);
  EXPECT_TRUE(wrong.wrong_name);
}

TEST(Score, CountsNothingAsNamedUnderTheVerdictAdequate) {
  const CaseScore silent =
      scored(friction(), answer("adequate", {named("coulomb_friction", 2, 0.9)}));
  EXPECT_FALSE(silent.right);
  EXPECT_FALSE(silent.wrong_name);
  EXPECT_TRUE(silent.silent);
}

TEST(Score, TakesAnUnsureNameWithItsSetForAName) {
  const json set = with_rival(named("coulomb_friction", 2, 0.35), "stribeck_friction", 2, 0.3);
  EXPECT_TRUE(scored(friction(), answer("explained", {set})).right);
  EXPECT_FALSE(scored(friction(), answer("explained", {named("coulomb_friction", 2, 0.35)})).right);
}

TEST(Score, FindsTheTruthInTheSetButNotAsTheName) {
  const json set = with_rival(named("stribeck_friction", 2, 0.6), "coulomb_friction", 2, 0.35);
  const CaseScore result = scored(friction(), answer("explained", {set}));
  EXPECT_TRUE(result.in_set);
  EXPECT_FALSE(result.right);
  EXPECT_TRUE(result.wrong_name) << "Stribeck with confidence is not there";
}

TEST(Score, LetsAnEquivalentStandForTheTruthOnlyWhenTheTruthIsListed) {
  const CaseTruth delay = truth("single", {effect("sensor_delay", 1, {{"delay", 3e-3}})});
  const json alone = named("actuation_delay", 1, 0.8);
  EXPECT_FALSE(scored(delay, answer("explained", {alone})).right);
  EXPECT_TRUE(scored(delay, answer("explained", {alone})).wrong_name);
  json listed = with_rival(named("actuation_delay", 1, 0.5), "sensor_delay", 1, 0.4);
  EXPECT_TRUE(scored(delay, answer("explained", {listed})).right);
  for (const char* kind : {"payload", "base_tilt", "time_base", "hand_impedance"}) {
    listed = with_rival(listed, kind, nullptr, 0.01);
  }
  EXPECT_FALSE(scored(delay, answer("explained", {listed})).right) << "five alternatives";
}

std::vector<EffectName> equivalents_of(const char* kind, int axis, const json& parameters) {
  return equivalents(truth("single", {effect(kind, axis, parameters)}).effects.front());
}

TEST(Score, LetsTheSimplerKindStandForTheRicherNotTheReverse) {
  const auto names = equivalents_of(
      "stribeck_friction", 2, {{"coulomb", 1.0}, {"static", 1.05}, {"stribeck_velocity", 0.1}});
  EXPECT_NE(std::find(names.begin(), names.end(), EffectName{"coulomb_friction", 2}), names.end());
  EXPECT_TRUE(equivalents_of("coulomb_friction", 2, {{"level", 1.0}}).empty());
}

TEST(Score, TakesGainForScaleOnAxesWithoutAWeightThatWouldTell) {
  for (const int axis : {1, 2, 3}) {
    EXPECT_EQ(equivalents_of("torque_gain", axis, {{"gain", 0.9}}).empty(), axis == 2) << axis;
  }
  const auto small = equivalents_of("torque_gain", 1, {{"gain", 0.98}});
  EXPECT_NE(std::find(small.begin(), small.end(), EffectName{"added_inertia", 1}), small.end());
}

TEST(Score, TakesABiasBesideFrictionForItsAsymmetry) {
  const CaseScore result = scored(
      friction(),
      answer("explained", {named("coulomb_friction", 2, 0.9), named("torque_bias", 2, 0.9)}));
  EXPECT_TRUE(result.right);
  EXPECT_FALSE(result.wrong_name);
  const CaseScore elsewhere = scored(
      friction(),
      answer("explained", {named("coulomb_friction", 2, 0.9), named("torque_bias", 1, 0.9)}));
  EXPECT_TRUE(elsewhere.wrong_name);
}

TEST(Score, CountsTheSourceOfACouplingAsPartOfItsName) {
  const CaseTruth coupling =
      truth("single", {effect("axis_coupling", 2, {{"fraction", 0.05}, {"from_axis", 3}})});
  json given = named("axis_coupling", 2, 0.9);
  given["parameters"] = {{{"name", "from_axis"}, {"value", 1}}};
  EXPECT_FALSE(scored(coupling, answer("explained", {given})).right);
  given["parameters"] = {{{"name", "from_axis"}, {"value", 3}}};
  EXPECT_TRUE(scored(coupling, answer("explained", {given})).right);
}

TEST(Score, WantsBothOfAPairAndNothingElse) {
  const CaseTruth pair = truth("pair", {effect("coulomb_friction", 2, {{"level", 0.01}}),
                                        effect("payload", nullptr, {{"mass", 0.01}})});
  const json both = {named("coulomb_friction", 2, 0.9), named("payload", nullptr, 0.8)};
  EXPECT_TRUE(scored(pair, answer("explained", both)).pair_exact);
  EXPECT_FALSE(scored(pair, answer("explained", {both[0]})).pair_exact);
  json surplus = both;
  surplus.push_back(named("time_base", nullptr, 0.7));
  EXPECT_FALSE(scored(pair, answer("explained", surplus)).pair_exact);
}

TEST(Score, WantsAStrangerFlaggedAndCallsItMisnamedOnlyWhenItIsSaidToBeExplained) {
  const CaseTruth stranger = truth("out_of_vocabulary", {effect("oov_catch", 2, json::object())});
  EXPECT_EQ(stranger.content(), Content::stranger);
  const json name = {named("coulomb_friction", 2, 0.9)};
  EXPECT_TRUE(scored(stranger, answer("explained", name)).misnamed);
  const CaseScore partly = scored(stranger, answer("partly_explained", name));
  EXPECT_TRUE(partly.flagged);
  EXPECT_FALSE(partly.misnamed);
  EXPECT_TRUE(scored(stranger, answer("unexplained", json::array())).flagged);
}

TEST(Score, TakesAMissingOrBrokenAnswerForWrong) {
  EXPECT_FALSE(read_answer(json()));
  EXPECT_FALSE(read_answer(json::array({1})));
  EXPECT_TRUE(read_answer({{"verdict", "adequate"}, {"effects", 3}, {"mismatch", "x"}}));
  const CaseScore missing = score(truth("null", {}), std::nullopt);
  EXPECT_TRUE(missing.missing);
  EXPECT_FALSE(missing.good());
}

TEST(Score, MeasuresErrorsAsTheFormatSays) {
  const CaseTruth gain = truth("single", {effect("torque_gain", 2, {{"gain", 0.9}})});
  json given = named("torque_gain", 2, 0.9);
  given["parameters"] = {{{"name", "gain"}, {"value", 0.91}, {"std", 0.005}}};
  const CaseScore result = scored(gain, answer("explained", {given}));
  ASSERT_EQ(result.parameters.size(), 1U);
  EXPECT_NEAR(result.parameters[0].relative, 0.1, 1e-9) << "of the departure from 1";
  EXPECT_EQ(result.parameters[0].covered, false);

  const CaseTruth tilt =
      truth("single", {effect("base_tilt", nullptr, {{"tilt_x", 0.03}, {"tilt_z", 0.04}})});
  json tilted = named("base_tilt", nullptr, 0.9);
  tilted["parameters"] = {{{"name", "tilt_x"}, {"value", 0.035}},
                          {{"name", "tilt_z"}, {"value", 0.04}}};
  EXPECT_NEAR(scored(tilt, answer("explained", {tilted})).parameters[0].relative, 0.1, 1e-9)
      << "of the whole tilt";
}

TEST(Score, RefusesATruthThatIsNone) {
  EXPECT_THROW((void)read_truth({{"case", "case-0001"}}), ConfigError);
}

}  // namespace
}  // namespace teleop
