#include "core/diagnosis/localisation.hpp"

#include <gtest/gtest.h>

#include "core/diagnosis/free_run.hpp"
#include "core/diagnosis/missing_means.hpp"
#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::make_case;
using testing::phantom;

EffectSpec effect(const char* kind, std::size_t axis, std::map<std::string, double> parameters) {
  return {.kind = kind, .axis = axis, .parameters = std::move(parameters)};
}

/// What a search finds that names the truth; nothing is searched.
SearchResult found_of(Likelihood& likelihood, const std::vector<EffectSpec>& effects) {
  SearchResult found;
  NoiseModel noise;
  noise.reading = likelihood.data().resolution / std::sqrt(12.0);
  likelihood.set_noise(noise);
  found.nominal.noise = fit_noise(likelihood, {}, noise);
  found.best.noise = noise;
  found.nominal.fit = fit(likelihood, base_columns(likelihood, {}), {});
  const MachineModel truth{.effects = effects};
  found.best.fit = fit(likelihood, base_columns(likelihood, truth), truth, {.iterations = 1});
  return found;
}

struct Located {
  DiagnosisCase data{};
  Localisation where{};
  FreeRun free{};
};

Located locate(const EffectSpec& planted, std::uint64_t seed) {
  Located located{.data = make_case({.effects = {planted}, .seconds = 4.0, .seed = seed})};
  Likelihood likelihood{located.data, phantom(), 1};
  const SearchResult found = found_of(likelihood, {planted});
  located.where = localise(likelihood, found);
  located.free = free_run(likelihood, found);
  return located;
}

TEST(TorqueSmoother, ShowsAConstantTorqueAtItsFullSize) {
  const double bias = 4e-3;
  const DiagnosisCase data = make_case(
      {.effects = {effect("torque_bias", 2, {{"bias", bias}})}, .runs = 1, .seconds = 3.0});
  NoiseModel noise;
  noise.reading = data.resolution / std::sqrt(12.0);
  const TorqueSmoother smoother{phantom(), data.runs[0], data.period_s, noise};
  const PlantTerms nothing = terms_of({});
  const auto rows = smoother.smooth({phantom(), nothing});
  ASSERT_EQ(rows.size(), data.runs[0].rows());
  JointVector mean = JointVector::Zero();
  for (std::size_t k = 300; k < rows.size(); ++k) {
    mean += rows[k].torque / static_cast<double>(rows.size() - 300);
  }
  EXPECT_NEAR(mean[2], bias, 0.03 * bias);
  EXPECT_NEAR(mean[0], 0.0, 0.1 * bias);
  EXPECT_NEAR(mean[1], 0.0, 0.1 * bias);
}

TEST(Localisation, DryFrictionIsAgainstTheMotionAtEverySpeed) {
  const Located located = locate(effect("coulomb_friction", 1, {{"level", 0.008}}), 3);
  EXPECT_TRUE(located.where.where.starts_with(
      "axis 2, against the direction of motion at every speed, all runs, "))
      << located.where.where;
  EXPECT_EQ(located.where.axis, 1U);
  const AxisMiss& before = located.where.nominal[1];
  EXPECT_NEAR(before.slow, 0.008, 0.002);
  EXPECT_NEAR(before.fast, 0.008, 0.002);
  EXPECT_NEAR(located.where.corrected[1].fast, 0.0, 0.0012);
  EXPECT_LT(located.where.corrected[1].torque, 0.5 * before.torque);
}

TEST(Localisation, ViscousFrictionGrowsWithSpeed) {
  const Located located = locate(effect("viscous_friction", 0, {{"coefficient", 0.012}}), 5);
  EXPECT_TRUE(
      located.where.where.starts_with("axis 1, against the direction of motion, more the "
                                      "faster"))
      << located.where.where;
}

TEST(Localisation, ABiasIsAConstantPush) {
  const Located located = locate(effect("torque_bias", 2, {{"bias", -0.006}}), 4);
  EXPECT_TRUE(located.where.where.starts_with("axis 3, a constant push in negative direction"))
      << located.where.where;
}

TEST(Localisation, FindsNothingWhereNothingIsMissing) {
  const DiagnosisCase data = make_case({.seconds = 4.0, .seed = 6});
  Likelihood likelihood{data, phantom(), 1};
  const Localisation where = localise(likelihood, found_of(likelihood, {}));
  EXPECT_EQ(where.where, "");
  std::size_t sure = 0;
  std::size_t seen = 0;
  for (const AxisMiss& miss : where.nominal) {
    for (const MissingMean& each : miss.map.cells) {
      if (each.rows == 0) continue;
      ++seen;
      sure += each.significant() ? 1U : 0U;
    }
  }
  EXPECT_GT(seen, 150U);
  EXPECT_LT(static_cast<double>(sure), 0.12 * static_cast<double>(seen));
}

TEST(FreeRun, OfTheTrueModelMissesWhatNoiseMakes) {
  const Located located = locate(effect("viscous_friction", 1, {{"coefficient", 0.01}}), 8);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(located.free.corrected[i] / located.free.noise[i], 1.0, 0.4) << "axis " << i + 1;
  }
  EXPECT_GT(located.free.nominal[1], 3.0 * located.free.corrected[1]);
}

TEST(BlockMeans, KnowHowSureTheyAre) {
  // Blocks of equal values: only their number counts.
  Random random{2};
  std::vector<CellSample> samples;
  constexpr std::size_t kBlocks = 64;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const double value = 1.0 + random.normal();
    for (int i = 0; i < 50; ++i) {
      samples.push_back({.cell = 0, .block = b, .value = value});
    }
  }
  const std::vector<MissingMean> means = block_means(samples, 2, kBlocks);
  EXPECT_NEAR(means[0].deviation, 1.0 / 8.0, 0.035);
  EXPECT_EQ(means[0].blocks, kBlocks);
  EXPECT_EQ(means[1].rows, 0U);
  EXPECT_FALSE(means[1].significant());
}

TEST(WhitenedSpectrum, OfUnitNoiseIsOne) {
  Random random{3};
  std::vector<double> noise;
  for (int i = 0; i < 40000; ++i) {
    noise.push_back(random.normal());
  }
  for (const double power : whitened_spectrum({noise}, 1e-3, {3.0, 20.0, 100.0, 400.0})) {
    EXPECT_NEAR(power, 1.0, 0.35);
  }
}

}  // namespace
}  // namespace teleop
