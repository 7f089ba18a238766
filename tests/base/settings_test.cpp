#include "core/base/settings.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

struct Example {
  double gain_N_per_m = 100.0;
  int priority = 80;
  bool enabled = true;
  std::string device = "sim";
  std::array<double, 3> rotation_rad{0.0, 0.0, 0.0};
};

class SettingsTest : public ::testing::Test {
 protected:
  SettingsTest() {
    settings_.add("law.gain_N_per_m", &example_.gain_N_per_m, "gain", kNotNegative);
    settings_.add("law.rotation_rad", &example_.rotation_rad, "rotation");
    settings_.add("loop.priority", &example_.priority, "priority", {1, 99});
    settings_.add("loop.enabled", &example_.enabled, "switch");
    settings_.add("device", &example_.device, "device");
  }

  /// The message of the error that loading `toml` raises.
  std::string complaint(const std::string& toml) {
    try {
      settings_.load_text(toml, "pair.toml");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return {};
  }

  Example example_;
  Settings settings_;
};

TEST_F(SettingsTest, ReadsEveryTypeAndRemembersWhereFrom) {
  settings_.load_text(
      "device = \"usb:1\"\n[law]\ngain_N_per_m = 5\nrotation_rad = [1, 2.5, 3]\n"
      "[loop]\npriority = 7\nenabled = false\n",
      "pair.toml");

  EXPECT_EQ(example_.gain_N_per_m, 5.0);
  EXPECT_EQ(example_.priority, 7);
  EXPECT_FALSE(example_.enabled);
  EXPECT_EQ(example_.device, "usb:1");
  EXPECT_EQ(example_.rotation_rad[1], 2.5);
  EXPECT_EQ(settings_.list()[0].origin, "pair.toml:3");
}

TEST_F(SettingsTest, NamesFileLineAndNearestKeyOfAMistypedOne) {
  EXPECT_EQ(complaint("[law]\ngain_N_per_mm = 5\n"),
            "pair.toml:2: unknown key 'law.gain_N_per_mm'; did you mean 'law.gain_N_per_m'?");
}

TEST_F(SettingsTest, RefusesWhatIsOutOfRangeOrOfAnotherTypeAndNamesThePlace) {
  EXPECT_EQ(complaint("[law]\ngain_N_per_m = -5\n"),
            "pair.toml:2: law.gain_N_per_m = -5: must be 0 or more");
  EXPECT_EQ(complaint("[law]\ngain_N_per_m = nan\n"),
            "pair.toml:2: law.gain_N_per_m = nan: must be 0 or more");
  EXPECT_EQ(complaint("[law]\ngain_N_per_m = \"5\"\n"),
            "pair.toml:2: law.gain_N_per_m: must be a number");
  EXPECT_EQ(complaint("[loop]\npriority = 100\n"),
            "pair.toml:2: loop.priority = 100: must be between 1 and 99");
  EXPECT_EQ(complaint("[loop]\npriority = 1.5\n"),
            "pair.toml:2: loop.priority: must be a whole number");
  EXPECT_EQ(complaint("[law]\nrotation_rad = [1, 2]\n"),
            "pair.toml:2: law.rotation_rad: must be a list of 3 numbers");
  EXPECT_EQ(example_.gain_N_per_m, 100.0);
}

TEST_F(SettingsTest, SaysWhereAFileIsNotToml) {
  EXPECT_EQ(complaint("[law]\ngain =\n").substr(0, 22), "pair.toml:2: not TOML:");
}

TEST_F(SettingsTest, TakesTheCommandLineOverTheFile) {
  settings_.load_text("[law]\ngain_N_per_m = 5\n", "pair.toml");
  settings_.set("law.gain_N_per_m", "7.5", "command line");
  settings_.set("device", "sim:two words.toml", "command line");

  EXPECT_EQ(example_.gain_N_per_m, 7.5);
  EXPECT_EQ(example_.device, "sim:two words.toml");
  EXPECT_EQ(settings_.list()[0].origin, "command line");
  EXPECT_THROW(settings_.set("law.gain_N_per_m", "7 5", "command line"), ConfigError);
}

TEST_F(SettingsTest, PrintsWhatItCanReadBack) {
  settings_.load_text(
      "device = \"a \\\"b\\\"\"\n[law]\ngain_N_per_m = 1e-9\nrotation_rad = [1, 2.5, 3]\n", "x");
  const std::string printed = settings_.print();
  example_ = {};

  settings_.load_text(printed, "printed");

  EXPECT_EQ(example_.gain_N_per_m, 1e-9);
  EXPECT_EQ(example_.device, "a \"b\"");
  EXPECT_EQ(example_.rotation_rad[2], 3.0);
}

TEST(DataFile, IsFoundInTheSourceTreeAndNamesThePlacesWhereItIsNot) {
  EXPECT_TRUE(std::filesystem::exists(data_file("CMakeLists.txt")));
  try {
    (void)data_file("arms/no-such-arm.toml");
    FAIL() << "found a file that is not there";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string{error.what()}.find("arms/no-such-arm.toml: no such file"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace teleop
