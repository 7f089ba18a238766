#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "tests/diagnosis_input/made_runs.hpp"

namespace teleop {
namespace {

using testing::complaints;
using testing::made_case;

TEST(Audit, IsSilentOnSoundRuns) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    EXPECT_EQ(complaints(audit(made_case(testing::ideal_plant(), seed))), "") << seed;
  }
}

TEST(Audit, IsSilentOnSlowRunsAndOnRunsThatBeginAtRest) {
  testing::Motion slow{.fastest_Hz = 0.5, .amplitude_rad = 0.1};
  EXPECT_EQ(complaints(audit(made_case(testing::ideal_plant(), 11, slow))), "");
}

/// An effect that a diagnosis is for must not pass for a fault of the recording.
TEST(Audit, TakesNoMissingPhysicsForAFaultOfTheRecording) {
  const std::vector<EffectSpec> effects{
      {.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.02}}},
      {.kind = "viscous_friction", .axis = 2, .parameters = {{"coefficient", 0.05}}},
      {.kind = "torque_gain", .axis = 0, .parameters = {{"gain", 0.7}}},
      {.kind = "torque_saturation", .axis = 2, .parameters = {{"limit", 0.03}}},
      {.kind = "torque_deadzone", .axis = 1, .parameters = {{"threshold", 0.004}}},
      {.kind = "actuation_delay", .axis = 0, .parameters = {{"delay", 0.003}}},
      {.kind = "backlash", .axis = 2, .parameters = {{"gap", 0.004}}},
      {.kind = "transmission_compliance",
       .axis = 1,
       .parameters = {{"stiffness", 3.0}, {"damping", 0.004}}},
      {.kind = "cable_spring", .axis = 0, .parameters = {{"stiffness", 0.5}, {"rest_angle", 0.1}}},
      {.kind = "axis_coupling", .axis = 0, .parameters = {{"fraction", 0.2}, {"from_axis", 2.0}}},
      {.kind = "payload", .parameters = {{"mass", 0.05}}},
      {.kind = "added_inertia", .axis = 2, .parameters = {{"inertia", 0.001}}},
      {.kind = "encoder_scale", .axis = 1, .parameters = {{"scale", 1.1}}},
      {.kind = "time_base", .parameters = {{"ratio", 1.05}}},
      {.kind = "contact",
       .axis = 1,
       .parameters = {{"location", 0.45}, {"stiffness", 5.0}, {"damping", 0.01}, {"side", 1.0}}},
      {.kind = "hand_impedance",
       .parameters = {{"stiffness", 200.0}, {"damping", 3.0}, {"mass", 0.1}}},
  };
  std::uint64_t seed = 20;
  for (const EffectSpec& effect : effects) {
    PlantSpec plant = testing::ideal_plant();
    plant.effects.push_back(effect);
    EXPECT_EQ(complaints(audit(made_case(plant, seed += 2))), "") << effect.kind;
  }
}

/// An effect of any size, friction of the shipped plant or none.
PlantSpec any_plant(Random& random) {
  PlantSpec plant = random.uniform() < 0.3 ? load_plant("phantom-1.5") : testing::ideal_plant();
  const std::size_t axis = random.bits() % 3;
  const std::vector<EffectSpec> effects{
      {.kind = "coulomb_friction",
       .axis = axis,
       .parameters = {{"level", random.uniform(0.001, 0.03)}}},
      {.kind = "torque_gain", .axis = axis, .parameters = {{"gain", random.uniform(0.6, 1.3)}}},
      {.kind = "backlash", .axis = axis, .parameters = {{"gap", random.uniform(0.0005, 0.01)}}},
      {.kind = "cable_spring",
       .axis = axis,
       .parameters = {{"stiffness", random.uniform(0.02, 1.0)}, {"rest_angle", 0.1}}},
      {.kind = "axis_coupling",
       .axis = 0,
       .parameters = {{"fraction", random.uniform(-0.4, 0.4)}, {"from_axis", 2.0}}},
      {.kind = "contact",
       .axis = axis,
       .parameters = {{"location", 0.3},
                      {"stiffness", random.uniform(0.5, 20.0)},
                      {"damping", 0.01},
                      {"side", 1.0}}},
      {.kind = "hand_impedance",
       .parameters = {{"stiffness", random.uniform(20.0, 500.0)},
                      {"damping", 3.0},
                      {"mass", random.uniform(0.01, 0.4)}}},
      {.kind = "torque_saturation",
       .axis = axis,
       .parameters = {{"limit", random.uniform(0.01, 0.06)}}},
  };
  plant.effects.push_back(effects[random.bits() % effects.size()]);
  return plant;
}

TEST(Audit, IsSilentWhateverTheEffectAndTheMotion) {
  Random random{50};
  for (int n = 0; n < testing::cases(30); ++n) {
    const PlantSpec plant = any_plant(random);
    const testing::Motion motion{.fastest_Hz = random.uniform(0.3, 8.0),
                                 .amplitude_rad = random.uniform(0.02, 0.25)};
    const std::string said =
        complaints(audit(made_case(plant, 1 + random.bits() % 100000, motion)));
    EXPECT_EQ(said, "") << n << ": " << plant.effects.back().kind;
  }
}

TEST(Audit, IsSilentOnTheChallenge) {
  if (!std::filesystem::exists(testing::shared("challenge"))) {
    GTEST_SKIP() << "the challenge is not here";
  }
  std::size_t cases = 0;
  for (const char* set : {"challenge/practice", "challenge/sealed"}) {
    for (const auto& entry : std::filesystem::directory_iterator{testing::shared(set)}) {
      if (!entry.is_directory()) continue;
      EXPECT_EQ(complaints(audit(read_case(entry.path()))), "") << entry.path();
      ++cases;
    }
  }
  EXPECT_EQ(cases, 36U);
}

}  // namespace
}  // namespace teleop
