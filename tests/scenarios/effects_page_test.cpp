#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "scenarios/effects.hpp"

namespace teleop {
namespace {

TEST(EffectsPage, IsTheVocabularyAsItStands) {
  std::ifstream file{TELEOP_SOURCE_DIR "/docs/effects.md"};
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), effects_as_markdown()) << "print it again: teleop effects --markdown";
}

}  // namespace
}  // namespace teleop
