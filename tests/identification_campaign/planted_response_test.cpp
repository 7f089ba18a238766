#include <cstdint>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "tests/identification/tally.hpp"

namespace teleop {
namespace {

/// Number of arms: 200, or as the environment says.
std::uint64_t cases() {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe): one thread
  return text == nullptr ? 200 : std::stoull(text);
}

TEST(PlantedResponseCampaign, IntervalsHoldTheTruthNineTimesOfTenAndNothingIsFarOff) {
  const testing::Tally tally = testing::planted_forms(1, cases());

  RecordProperty("estimates", tally.estimates);
  RecordProperty("covered", tally.covered);
  EXPECT_EQ(tally.masses_and_springs_off, 0) << "of " << tally.estimates;
  EXPECT_EQ(tally.dampers_off, 0) << "of " << tally.estimates;
  EXPECT_GE(tally.covered, 0.86 * tally.estimates) << "of " << tally.estimates;
  EXPECT_LE(tally.covered, 0.94 * tally.estimates) << "of " << tally.estimates;
}

}  // namespace
}  // namespace teleop
