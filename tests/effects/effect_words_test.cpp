#include "core/effects/effect_words.hpp"

#include <gtest/gtest.h>

#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

/// Every parameter a little away from where the effect would not be there.
EffectSpec some(const EffectKind& kind) {
  EffectSpec effect{.kind = std::string{kind.name}};
  if (kind.per_axis) effect.axis = 1;
  for (const EffectParameter& parameter : kind.parameters) {
    double value = parameter.name == "side" ? -1.0 : 0.012;
    if (parameter.neutral == 1.0) value = 0.93;
    if (parameter.name == "static") value = 0.02;
    value = std::max(value, parameter.range.low);
    if (parameter.unit == "1 to 3") value = 3.0;
    effect.parameters[std::string{parameter.name}] = value;
  }
  return effect;
}

TEST(EffectWords, EveryKindSpeaksOfItselfInOneSentence) {
  for (const EffectKind* kind : vocabulary()) {
    ASSERT_NE(kind->words, nullptr) << kind->name;
    const std::string sentence = sentence_of(some(*kind));
    EXPECT_GT(sentence.size(), 25U) << kind->name;
    EXPECT_EQ(sentence.back(), '.') << sentence;
    EXPECT_EQ(sentence.find('_'), std::string::npos) << sentence;
    EXPECT_EQ(sentence.starts_with("Axis 2 "), kind->per_axis) << sentence;
    EXPECT_NE(sentence.find_first_of("0123456789", 7), std::string::npos) << sentence;
  }
}

TEST(EffectWords, TellSizeAndErrorAsPeopleWriteThem) {
  const EffectSpec friction{
      .kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.0112}}};
  EXPECT_EQ(sentence_of(friction, {{"level", 0.0009}}),
            "Axis 2 loses 11.2 ± 0.9 mNm against every motion: dry friction.");
  EXPECT_EQ(sentence_of(friction, {{"level", 0.0012}}),
            "Axis 2 loses 11 ± 1 mNm against every motion: dry friction.");
}

TEST(EffectWords, TellWhichWayAGainIsOff) {
  EffectSpec gain{.kind = "torque_gain", .axis = 0, .parameters = {{"gain", 0.93}}};
  EXPECT_NE(sentence_of(gain, {{"gain", 0.002}}).find("delivers 7.0 ± 0.2 % less torque"),
            std::string::npos);
  gain.parameters["gain"] = 1.05;
  EXPECT_NE(sentence_of(gain).find("5.00 % more torque"), std::string::npos);
}

TEST(EffectWords, SayAsymmetryOnlyWhereThereIsOne) {
  EffectSpec friction{.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", 0.01}}};
  EXPECT_EQ(sentence_of(friction).find("more than the mean"), std::string::npos);
  friction.parameters["asymmetry"] = -0.2;
  EXPECT_NE(sentence_of(friction).find("20.0 % more than the mean in negative motion"),
            std::string::npos)
      << sentence_of(friction);
}

TEST(QuantityText, ChoosesHandyUnits) {
  EXPECT_EQ(quantity_text(0.0, 0.0, "N m"), "0 Nm");
  EXPECT_EQ(quantity_text(-0.0042, 0.0001, "N m"), "−4.2 ± 0.1 mNm");
  EXPECT_EQ(quantity_text(2.1e-4, 3e-6, "s"), "210 ± 3 µs");
  EXPECT_EQ(quantity_text(9.6e-6, 2e-7, "kg m^2"), "9.6 ± 0.2 kg mm²");
  EXPECT_EQ(quantity_text(0.0123, 0.0, "kg"), "12.3 g");
  EXPECT_EQ(quantity_text(0.0, 0.01, "1"), "0 ± 1 %");
}

}  // namespace
}  // namespace teleop
