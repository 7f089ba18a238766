#include <cmath>

#include <gtest/gtest.h>

#include "core/diagnosis/fit.hpp"
#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/torque_response.hpp"
#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::MadeCase;
using testing::make_case;
using testing::phantom;

const EffectSpec kFriction{.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.006}}};

NoiseModel noise_of(const DiagnosisCase& data) {
  NoiseModel noise;
  noise.reading = data.resolution / std::sqrt(12.0);
  return noise;
}

double rms(const Eigen::VectorXf& w) {
  return std::sqrt(w.cast<double>().squaredNorm() / static_cast<double>(w.size()));
}

TEST(Innovations, OfTheTrueModelAreWhiteAndOfUnitVariance) {
  const DiagnosisCase data = make_case({.effects = {kFriction}});
  Likelihood likelihood{data, phantom(), 1};
  likelihood.set_noise(noise_of(data));
  for (std::size_t run = 0; run < likelihood.runs(); ++run) {
    const Eigen::VectorXf w = likelihood.errors(run, {.effects = {kFriction}});
    EXPECT_NEAR(rms(w), 1.0, 0.03);
    for (const Eigen::Index lag : {1, 2, 5, 20}) {
      const Eigen::Index n = w.size() - 3 * lag;
      const double correlation =
          static_cast<double>(w.head(n).dot(w.tail(n))) / static_cast<double>(n);
      EXPECT_NEAR(correlation, 0.0, 0.05) << "lag " << lag;
    }
    EXPECT_GT(rms(likelihood.errors(run, {})), 1.1) << "friction left out";
  }
}

TEST(Innovations, DoNotDependOnTheIntegratorsStep) {
  const EffectSpec stribeck{
      .kind = "stribeck_friction",
      .axis = 0,
      .parameters = {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.1}}};
  const EffectSpec lag{.kind = "amplifier_lag", .axis = 2, .parameters = {{"time_constant", 1e-3}}};
  const std::vector<EffectSpec> effects{stribeck, kFriction, lag};
  const DiagnosisCase data = make_case({.effects = effects, .runs = 1});
  const NoiseModel noise = noise_of(data);
  const Tether tether{phantom(), data.runs[0], data.period_s, noise};
  const PlantTerms terms = terms_of(effects);
  const auto whole = predict({phantom(), terms}, data.runs[0], data.period_s, tether);
  const auto half = predict({phantom(), terms, 2}, data.runs[0], data.period_s, tether);
  double moved = 0.0;
  double size = 0.0;
  for (std::size_t k = 50; k < whole.innovations.size(); ++k) {
    moved += (whole.innovations[k] - half.innovations[k]).squaredNorm();
    size += whole.innovations[k].squaredNorm();
  }
  EXPECT_GT(moved, 0.0) << "the step was not halved";
  EXPECT_LT(std::sqrt(moved / size), 0.01);
}

TEST(NoiseFit, FindsTheColourAndLevelOfTheDisturbance) {
  NoiseModel truth;
  truth.coloured = {1.5e-3, 8e-4, 4e-4};
  truth.time_constant = {0.02, 0.04, 0.03};
  const DiagnosisCase data = make_case({.noise = truth, .runs = 4, .seconds = 4.0});
  Likelihood likelihood{data, phantom(), 1};
  const NoiseModel found = fit_noise(likelihood, {}, noise_of(data));
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.coloured[i], truth.coloured[i], 0.15 * truth.coloured[i]) << "axis " << i + 1;
    EXPECT_NEAR(found.time_constant[i], truth.time_constant[i], 0.3 * truth.time_constant[i]);
    EXPECT_NEAR(found.reading[i] / data.resolution[i], 1.0 / std::sqrt(12.0), 0.02);
  }
}

TEST(TorqueResponse, IsTheSlopeOfTheTetheredSimulation) {
  const DiagnosisCase data = make_case({.runs = 1});
  Likelihood likelihood{data, phantom(), 1};
  likelihood.set_noise(noise_of(data));
  const double bias = 1e-4;
  const EffectSpec constant{.kind = "torque_bias", .axis = 2, .parameters = {{"bias", bias}}};
  const Eigen::VectorXf simulated =
      likelihood.errors(0, {.effects = {constant}}) - likelihood.errors(0, {});
  const std::vector<JointVector> torque(data.runs[0].rows(), JointVector{0.0, 0.0, bias});
  const Eigen::VectorXf linear =
      torque_response(likelihood.tether(0), mobilities(phantom(), data.runs[0]), data.period_s,
                      torque, Likelihood::kSettling);
  EXPECT_LT((simulated - linear).norm(), 0.03F * simulated.norm());
}

TEST(BaseColumns, AgreeWithCentralDifferences) {
  const DiagnosisCase data = make_case({.runs = 1});
  Likelihood likelihood{data, phantom(), 1};
  likelihood.set_noise(noise_of(data));
  const BaseColumns columns = base_columns(likelihood, {});
  for (Eigen::Index i = 0; i < BasePrior::kSize; ++i) {
    MachineModel up;
    MachineModel down;
    up.base[i] = 1.0;
    down.base[i] = -1.0;
    const Eigen::VectorXf central = (likelihood.errors(0, up) - likelihood.errors(0, down)) / 2.0F;
    EXPECT_LT((central - columns[0].col(i)).norm(), 0.02F * central.norm() + 1e-2F) << i;
  }
}

}  // namespace
}  // namespace teleop
