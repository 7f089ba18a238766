#include "core/effects/vocabulary.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

std::string message_of(const EffectSpec& effect) {
  try {
    check(effect);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

EffectSpec coulomb(std::size_t axis, double level) {
  return {.kind = "coulomb_friction", .axis = axis, .parameters = {{"level", level}}};
}

TEST(Vocabulary, NamesEachKindAndParameterOnceAndExplainsIt) {
  std::set<std::string_view> kinds;
  for (const EffectKind* kind : vocabulary()) {
    EXPECT_TRUE(kinds.insert(kind->name).second) << kind->name;
    EXPECT_FALSE(kind->law.empty()) << kind->name;
    EXPECT_NE(kind->plug, nullptr) << kind->name;
    std::set<std::string_view> names{"kind", "axis"};
    for (const EffectParameter& parameter : kind->parameters) {
      EXPECT_TRUE(names.insert(parameter.name).second) << kind->name << ' ' << parameter.name;
      EXPECT_FALSE(parameter.unit.empty() || parameter.text.empty()) << parameter.name;
    }
  }
}

TEST(Vocabulary, SplitsAsymmetryBetweenTheDirectionsAsItsLawSays) {
  const std::array effects{EffectSpec{.kind = "viscous_friction",
                                      .axis = 1,
                                      .parameters = {{"coefficient", 0.1}, {"asymmetry", 0.2}}},
                           EffectSpec{.kind = "coulomb_friction",
                                      .axis = 1,
                                      .parameters = {{"level", 0.01}, {"asymmetry", -0.5}}}};
  const JointFriction friction = terms_of(effects).friction[1];
  EXPECT_DOUBLE_EQ(friction.viscous_forward, 0.12);
  EXPECT_DOUBLE_EQ(friction.viscous_backward, 0.08);
  EXPECT_DOUBLE_EQ(friction.dry_forward, 0.005);
  EXPECT_DOUBLE_EQ(friction.dry_backward, 0.015);
}

TEST(Vocabulary, SumsEffectsOfOneAxisAndLeavesTheOthersAlone) {
  const std::array effects{coulomb(2, 0.01), coulomb(2, 0.02)};
  const PlantTerms terms = terms_of(effects);
  EXPECT_DOUBLE_EQ(terms.friction[2].dry_forward, 0.03);
  EXPECT_FALSE(terms.friction[0].has_corner());
  EXPECT_FALSE(terms.friction[1].has_corner());
}

TEST(Vocabulary, ListsTheKindsWhenOneIsUnknown) {
  const std::string message = message_of({.kind = "colomb_friction", .axis = 0});
  EXPECT_NE(message.find("'colomb_friction'"), std::string::npos) << message;
  EXPECT_NE(message.find("viscous_friction, coulomb_friction"), std::string::npos) << message;
}

TEST(Vocabulary, ListsTheKeysWhenOneIsUnknown) {
  EffectSpec effect = coulomb(0, 0.01);
  effect.parameters["levle"] = 0.01;
  const std::string message = message_of(effect);
  EXPECT_NE(message.find("'levle'"), std::string::npos) << message;
  EXPECT_NE(message.find("kind, axis, level, asymmetry"), std::string::npos) << message;
}

TEST(Vocabulary, RefusesParametersThatAreMissingOrOutOfRange) {
  EXPECT_NE(message_of({.kind = "coulomb_friction", .axis = 0}).find("level is missing"),
            std::string::npos);
  EXPECT_NE(message_of(coulomb(0, -0.01)).find("level = -0.01 N m: must be 0 or more"),
            std::string::npos);
  EXPECT_NE(message_of(coulomb(0, std::numeric_limits<double>::quiet_NaN())), "");
  EffectSpec lopsided = coulomb(0, 0.01);
  lopsided.parameters["asymmetry"] = 1.5;
  EXPECT_NE(message_of(lopsided).find("from -1 to 1"), std::string::npos);
}

TEST(Vocabulary, RefusesAnAxisThatIsMissingOrDoesNotExist) {
  EXPECT_NE(message_of({.kind = "coulomb_friction", .parameters = {{"level", 0.1}}}), "");
  EXPECT_NE(message_of(coulomb(3, 0.01)).find("allowed: 1, 2, 3"), std::string::npos);
  EXPECT_EQ(message_of(coulomb(2, 0.01)), "");
}

}  // namespace
}  // namespace teleop
