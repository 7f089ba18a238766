#include "core/effects/plant_spec.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {
namespace {

constexpr std::string_view kFull = R"(arm = "phantom-1.5"
name = "bench"
[sensing]
quantised = false
[drive]
torque_command_step_Nm = 1e-5
delay_samples = 1
max_force_N = 8.5
[watchdog]
timeout_ms = 30
[workspace]
stops = false
[integration]
max_step_ms = 0.25
[[effect]]
kind = "viscous_friction"
axis = 1
coefficient = 0.05
[[effect]]
kind = "coulomb_friction"
axis = 3
level = 0.0068
asymmetry = -0.1
)";

std::string message_of(std::string_view toml) {
  try {
    [[maybe_unused]] const PlantSpec plant = parse_plant(toml, "plant.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

void expect_in(const std::string& part, const std::string& message) {
  EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
}

TEST(PlantSpec, ReadsEveryTable) {
  const PlantSpec plant = parse_plant(kFull, "plant.toml");
  EXPECT_EQ(plant.name, "bench");
  EXPECT_FALSE(plant.sensing.quantised);
  EXPECT_EQ(plant.drive.delay_samples, 1);
  EXPECT_EQ(plant.drive.torque_command_step_Nm, 1e-5);
  EXPECT_EQ(plant.drive.max_force_N, 8.5);
  EXPECT_EQ(plant.watchdog.timeout_ms, 30.0);
  EXPECT_FALSE(plant.workspace.stops);
  EXPECT_EQ(plant.integration.max_step_ms, 0.25);
  ASSERT_EQ(plant.effects.size(), 2U);
  EXPECT_EQ(plant.effects[1].axis, 2U);
  EXPECT_EQ(plant.effects[1].parameters.at("asymmetry"), -0.1);
}

TEST(PlantSpec, WritesWhatItReadsBackUnchanged) {
  const PlantSpec plant = parse_plant(kFull, "plant.toml");
  const std::string text = to_toml(plant);
  const PlantSpec again = parse_plant(text, "again.toml");
  EXPECT_EQ(to_toml(again), text);
  EXPECT_EQ(again.effects, plant.effects);
  EXPECT_EQ(again.drive.torque_command_step_Nm, plant.drive.torque_command_step_Nm);
  EXPECT_EQ(again.workspace.stops, plant.workspace.stops);
}

TEST(PlantSpec, NamesTheLineOfAnUnknownKindAndListsTheKnown) {
  const std::string message = message_of("\n[[effect]]\naxis = 1\nkind = \"backlsh\"\n");
  expect_in("plant.toml:4: unknown effect kind 'backlsh'", message);
  expect_in("viscous_friction, coulomb_friction", message);
}

TEST(PlantSpec, NamesTheLineOfAnUnknownKeyAndListsTheKnown) {
  const std::string effect =
      message_of("[[effect]]\nkind = \"coulomb_friction\"\naxis = 1\nlevel = 1.0\nlevl = 1.0\n");
  expect_in("plant.toml:5: coulomb_friction: unknown key 'levl'", effect);
  expect_in("level, asymmetry", effect);
  const std::string table = message_of("arm = \"x\"\n[drive]\ndelay = 1\n");
  expect_in("plant.toml:3: unknown key 'drive.delay'", table);
  expect_in("drive.delay_samples", table);
}

TEST(PlantSpec, NamesTheLineOfAValueThatCannotBe) {
  expect_in("plant.toml:4: coulomb_friction: level = -1",
            message_of("[[effect]]\nkind = \"coulomb_friction\"\naxis = 1\nlevel = -1\n"));
  expect_in("plant.toml:3: coulomb_friction: axis = 0: allowed: 1, 2, 3",
            message_of("[[effect]]\nkind = \"coulomb_friction\"\naxis = 0\nlevel = 1\n"));
  expect_in("plant.toml:4: coulomb_friction: level must be a number",
            message_of("[[effect]]\nkind = \"coulomb_friction\"\naxis = 1\nlevel = \"1\"\n"));
  expect_in("plant.toml:1: coulomb_friction: level is missing",
            message_of("[[effect]]\nkind = \"coulomb_friction\"\naxis = 1\n"));
  expect_in("plant.toml:1: an effect needs kind", message_of("[[effect]]\naxis = 1\n"));
  expect_in("plant.toml:2", message_of("[drive]\ndelay_samples = 99\n"));
  expect_in("plant.toml:2", message_of("[drive]\ndelay_samples = 0.5\n"));
  expect_in("plant.toml:1: arm = 5: wrong type", message_of("arm = 5\n"));
  expect_in("plant.toml:1", message_of("effect = 3\n"));
  expect_in("plant.toml:1: not TOML", message_of("arm = \n"));
}

TEST(PlantSpec, RefusesAFileThatIsNotThere) {
  EXPECT_THROW([[maybe_unused]] const auto plant = load_plant("no-such-plant"), ConfigError);
  EXPECT_THROW([[maybe_unused]] const auto plant = load_plant("/no/such/plant.toml"), ConfigError);
}

TEST(PlantSpec, ShipsADefaultPlantWhoseFrictionIsThatOfTheToolAtHome) {
  const PlantSpec plant = load_plant("phantom-1.5");
  const ArmParameters arm = load_arm(plant.arm).parameters();
  const PlantTerms terms = terms_of(plant.effects);
  const std::array levers{arm.l1_m, arm.l1_m, arm.l2_m};
  for (std::size_t i = 0; i < kJoints; ++i) {
    EXPECT_NEAR(terms.friction.at(i).viscous_forward, 1.115 * levers.at(i) * levers.at(i), 1e-9);
    EXPECT_NEAR(terms.friction.at(i).dry_backward, 0.04 * levers.at(i), 1e-9);
  }
}

TEST(PlantSpec, ShipsABarePlantWithoutEffects) {
  EXPECT_TRUE(load_plant("phantom-1.5-bare").effects.empty());
}

TEST(PlantSpec, OfEveryEffectLeavesNoneOut) {
  const PlantSpec plant = load_plant("phantom-1.5-everything");
  for (const EffectKind* kind : vocabulary()) {
    EXPECT_TRUE(std::any_of(plant.effects.begin(), plant.effects.end(),
                            [&](const EffectSpec& effect) { return effect.kind == kind->name; }))
        << kind->name;
  }
}

}  // namespace
}  // namespace teleop
