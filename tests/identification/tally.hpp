#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/identification/planted_arm.hpp"

namespace teleop::testing {

/// How many estimates of many arms were where.
struct Tally {
  int estimates = 0;
  int covered = 0;
  int masses_and_springs_off = 0;  ///< by more than 2 %
  int dampers_off = 0;             ///< by more than 10 %
};

inline void add(Tally& tally, const PlantedArm& planted, const FrequencyResponse& response) {
  const MechanicalFit fit =
      fit_mechanical(planted.form, measured(response), {.period_s = 1.0 / 10000.0});
  const Eigen::VectorXd truth = planted.true_values();
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    const Estimate& estimate = fit.estimates.at(static_cast<std::size_t>(k));
    const double error = std::abs(estimate.value / truth(k) - 1.0);
    ++tally.estimates;
    tally.covered += static_cast<int>(estimate.low <= truth(k) && truth(k) <= estimate.high);
    if (estimate.name == "b") {
      tally.dampers_off += static_cast<int>(error > 0.10);
    } else {
      tally.masses_and_springs_off += static_cast<int>(error > 0.02);
    }
  }
}

/// Seeds count up from the first; all arms must be measured, at rest and without false alarm.
inline Tally planted_forms(std::uint64_t first_seed, std::uint64_t count) {
  Tally tally;
  for (std::uint64_t seed = first_seed; seed < first_seed + count; ++seed) {
    const PlantedArm planted{seed};
    const ResponseMeasurement measurement = measure(planted, {.seed = seed});
    EXPECT_TRUE(measurement.response.has_value()) << "seed " << seed;
    if (!measurement.response) continue;
    EXPECT_FALSE(measurement.response->distorted) << "seed " << seed;
    EXPECT_TRUE(measurement.drives.back().at_rest) << "seed " << seed;
    add(tally, planted, *measurement.response);
  }
  return tally;
}

}  // namespace teleop::testing
