#include "scenarios/regression/regression.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/model/dynamics.hpp"
#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::make_case;
using testing::phantom;

nlohmann::json answer_of(const DiagnosisCase& data, Counting counting) {
  return regress(Design{data, phantom()}, data, counting);
}

TEST(ZeroPhaseFilter, PassesSlowAndStopsFastMotionWithoutPhase) {
  const ZeroPhaseFilter filter{40.0, 1e-3};
  const auto wave = [](double frequency_Hz) {
    Signal signal;
    for (int k = 0; k < 4000; ++k) {
      signal.push_back(
          JointVector::Constant(std::sin(2.0 * std::numbers::pi * frequency_Hz * 1e-3 * k)));
    }
    return signal;
  };
  for (const auto& [frequency_Hz, gain] : {std::pair{4.0, 1.0}, {40.0, 0.5}, {400.0, 0.0}}) {
    const Signal before = wave(frequency_Hz);
    const Signal after = filter(before);
    double product = 0.0;
    double square = 0.0;
    for (std::size_t k = 1000; k < 3000; ++k) {
      product += before[k][0] * after[k][0];
      square += before[k][0] * before[k][0];
    }
    EXPECT_NEAR(product / square, gain, 1e-3) << frequency_Hz << " Hz";
  }
}

TEST(Regression, FindsObviousFriction) {
  const DiagnosisCase data = make_case(
      {.effects = {{.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.02}}}},
       .seed = 7});
  for (const Counting counting : {Counting::samples, Counting::correlated}) {
    const nlohmann::json answer = answer_of(data, counting);
    ASSERT_FALSE(answer.at("effects").empty());
    const nlohmann::json& first = answer["effects"][0];
    EXPECT_EQ(first.at("kind"), "coulomb_friction") << answer;
    EXPECT_EQ(first.at("axis"), 2);
    EXPECT_NEAR(first.at("parameters").at(0).at("value"), 0.02, 0.004) << answer;
    EXPECT_GT(answer.at("fit").at("nominal_nrmse"), answer.at("fit").at("corrected_nrmse"));
  }
}

TEST(Regression, NamesNoMoreByCorrelatedThanByPlainCounting) {
  const DiagnosisCase data = make_case({.seed = 11});
  const Design design{data, phantom()};
  EXPECT_LE(regress(design, data, Counting::correlated).at("effects").size(),
            regress(design, data, Counting::samples).at("effects").size());
}

TEST(Regression, AnswersTheSameTwice) {
  const DiagnosisCase data = make_case(
      {.effects = {{.kind = "torque_gain", .axis = 1, .parameters = {{"gain", 0.9}}}}, .seed = 3});
  EXPECT_EQ(answer_of(data, Counting::correlated).dump(),
            answer_of(data, Counting::correlated).dump());
}

}  // namespace
}  // namespace teleop
