#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/diagnosis/answer.hpp"
#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::make_case;
using testing::phantom;

Diagnosis diagnosis_of(const DiagnosisCase& data, std::size_t threads = 1) {
  Likelihood likelihood{data, phantom(), threads};
  return diagnose(likelihood, {});
}

class Planted : public ::testing::TestWithParam<EffectSpec> {};

TEST_P(Planted, EffectIsNamedAndEstimated) {
  const EffectSpec& planted = GetParam();
  const DiagnosisCase data = make_case({.effects = {planted}, .seed = 7});
  const Diagnosis diagnosis = diagnosis_of(data);
  EXPECT_EQ(text_of(diagnosis.verdict), "explained");
  ASSERT_EQ(diagnosis.found.effects.size(), 1U);
  const NamedEffect& named = diagnosis.found.effects.front();
  EXPECT_EQ(named.effect.kind, planted.kind);
  EXPECT_EQ(named.effect.axis, planted.axis);
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const std::string& name = named.free[i].name;
    const double truth = planted.parameters.at(name);
    const double found = named.effect.parameters.at(name);
    const double sigma = named.deviations[static_cast<Eigen::Index>(i)] *
                         (named.free[i].logarithmic ? std::abs(found) : 1.0);
    EXPECT_NEAR(found, truth, 4.0 * sigma) << name;
    EXPECT_LT(sigma, 0.3 * std::abs(truth) + 1e-3) << name;
  }
  EXPECT_LT(diagnosis.fit.corrected, 1.03);
  EXPECT_GT(diagnosis.fit.nominal, diagnosis.fit.corrected);
}

EffectSpec effect(const char* kind, std::size_t axis, std::map<std::string, double> parameters) {
  return {.kind = kind, .axis = axis, .parameters = std::move(parameters)};
}

INSTANTIATE_TEST_SUITE_P(Kinds,
                         Planted,
                         ::testing::Values(effect("coulomb_friction", 1, {{"level", 0.005}}),
                                           effect("viscous_friction", 0, {{"coefficient", 0.005}}),
                                           effect("torque_deadzone", 2, {{"threshold", 0.003}}),
                                           effect("amplifier_lag", 1, {{"time_constant", 3e-3}}),
                                           effect("sensor_delay", 1, {{"delay", 6.3e-3}}),
                                           effect("torque_gain", 1, {{"gain", 0.93}})),
                         [](const auto& tested) { return tested.param.kind; });

TEST(Search, NamesNothingWhereNothingIsMissing) {
  const Diagnosis diagnosis = diagnosis_of(make_case({.seed = 11}));
  EXPECT_EQ(text_of(diagnosis.verdict), "adequate");
  EXPECT_TRUE(diagnosis.found.effects.empty());
  EXPECT_GT(diagnosis.p_value, 0.01);
}

TEST(Search, AnswersTheSameOnAnyNumberOfThreads) {
  const DiagnosisCase data = make_case(
      {.effects = {effect("coulomb_friction", 2, {{"level", 0.003}})}, .runs = 2, .seconds = 2.0});
  const auto one = answer_of(diagnosis_of(data, 1), data);
  const auto two = answer_of(diagnosis_of(data, 2), data);
  EXPECT_EQ(one.dump(), two.dump());
}

TEST(Search, AnswersInTheAgreedShape) {
  const DiagnosisCase data =
      make_case({.effects = {effect("viscous_friction", 1, {{"coefficient", 0.006}})}, .runs = 2});
  const auto answer = answer_of(diagnosis_of(data), data);
  EXPECT_EQ(answer.at("verdict"), "explained");
  EXPECT_EQ(answer.at("mismatch").at("axes"), nlohmann::json::array({2}));
  EXPECT_EQ(answer.at("mismatch").at("channel"), "joint");
  const auto& first = answer.at("effects").at(0);
  EXPECT_EQ(first.at("kind"), "viscous_friction");
  EXPECT_EQ(first.at("parameters").at(0).at("unit"), "N m s/rad");
  EXPECT_EQ(answer.at("fit").at("held_out_runs").size(), 2U);
}

}  // namespace
}  // namespace teleop
