#include "core/model/arm_model.hpp"

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/model/kinematics.hpp"
#include "tests/model/postures.hpp"

namespace teleop {
namespace {

using testing::phantom;

std::string message_of(const ArmParameters& parameters) {
  try {
    const ArmModel arm{parameters};
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// The shipped arm file with one text replaced, as a file of its own.
std::filesystem::path altered_file(const std::string& old_text, const std::string& new_text) {
  std::ifstream shipped{TELEOP_SOURCE_DIR "/scenarios/arms/phantom-1.5.toml"};
  std::stringstream stream;
  stream << shipped.rdbuf();
  std::string text = stream.str();
  const std::size_t place = text.find(old_text);
  EXPECT_NE(place, std::string::npos) << old_text;
  text.replace(place, old_text.size(), new_text);
  const auto file =
      std::filesystem::path{::testing::TempDir()} /
      (std::string{::testing::UnitTest::GetInstance()->current_test_info()->name()} + ".toml");
  std::ofstream{file} << text;
  return file;
}

std::string message_of_file(const std::filesystem::path& file) {
  try {
    [[maybe_unused]] const ArmModel arm = load_arm(file.string());
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ArmModel, LumpsTheParametersAsTheCorrectedPaperDoes) {
  const ArmModel::Lumped& lumped = phantom().lumped();
  EXPECT_NEAR(lumped.K, 9.1229875e-4, 1e-18);
  EXPECT_NEAR(lumped.S0, 2.832787775e-3, 1e-17);
  EXPECT_NEAR(lumped.S2, 1.1318928125e-3, 1e-17);
  EXPECT_NEAR(lumped.S3, 3.912006625e-4, 1e-17);
  EXPECT_NEAR(lumped.M22, 2.426395625e-3, 1e-17);
  EXPECT_NEAR(lumped.M33, 9.31885625e-4, 1e-17);
  EXPECT_NEAR(lumped.N2, -0.0162980397, 1e-16);
  EXPECT_NEAR(lumped.N3, -0.0737552097, 1e-16);
}

TEST(ArmModel, HomeIsFarFromEveryStopAndStopsLieInsideTheBranchOfThePaper) {
  const ArmParameters& arm = phantom().parameters();
  const double clearance = 29.0 * std::numbers::pi / 180.0 - 1e-12;
  for (std::size_t i = 0; i < kJoints; ++i) {
    EXPECT_LE(arm.lower_limit_rad.at(i), -clearance);
    EXPECT_GE(arm.upper_limit_rad.at(i), clearance);
  }
  EXPECT_GE(arm.max_q2_minus_q3_rad, clearance);
  EXPECT_GE(arm.max_q3_minus_q2_rad, clearance);
  EXPECT_LT(arm.max_q2_minus_q3_rad, std::numbers::pi / 2.0);
  EXPECT_LT(arm.max_q3_minus_q2_rad, std::numbers::pi / 2.0);
}

TEST(ArmModel, TorqueLimitGivesTheForceLimitAlongZAtHome) {
  const ArmParameters& arm = phantom().parameters();
  EXPECT_NEAR(arm.max_torque_Nm[2] / arm.l2_m, arm.max_force_N, 0.01);
}

/// Puts `wrong` into every number of an arm in turn that `chosen` takes, and expects its key named.
template <typename Chosen>
int refusals(double wrong, const Chosen& chosen) {
  ArmParameters parameters = phantom().parameters();
  Settings settings;
  add_settings(settings, "", parameters);
  int tried = 0;
  for (const Setting& setting : settings.list()) {
    double* value = nullptr;
    if (double* const* single = std::get_if<double*>(&setting.target)) value = *single;
    if (auto* const* list = std::get_if<std::array<double, 3>*>(&setting.target)) {
      value = &(*list)->back();
    }
    if (value == nullptr || !chosen(setting)) continue;
    const double kept = std::exchange(*value, wrong);
    EXPECT_NE(message_of(parameters).find(setting.key), std::string::npos) << setting.key;
    *value = kept;
    ++tried;
  }
  EXPECT_EQ(message_of(parameters), "");
  return tried;
}

TEST(ArmModel, RefusesEveryParameterThatIsNotAFiniteNumber) {
  const auto all = [](const Setting&) {
    return true;
  };
  EXPECT_EQ(refusals(std::numeric_limits<double>::quiet_NaN(), all), 24);
  EXPECT_EQ(refusals(std::numeric_limits<double>::infinity(), all), 24);
}

TEST(ArmModel, RefusesLengthsMassesInertiasAndDriveThatAreNotPositive) {
  const auto positive = [](const Setting& setting) {
    const bool is_offset = setting.key == "geometry.l5_m" || setting.key == "geometry.l6_m";
    const bool is_angle = setting.key.starts_with("limits.") && setting.key.ends_with("rad");
    return !is_offset && !is_angle && setting.key != "gravity_m_per_s2";
  };
  EXPECT_EQ(refusals(0.0, positive), 17);
  EXPECT_EQ(refusals(-0.1, positive), 17);
}

TEST(ArmModel, RefusesLimitsThatLeaveNoRoom) {
  ArmParameters parameters = phantom().parameters();
  std::swap(parameters.lower_limit_rad[1], parameters.upper_limit_rad[1]);
  EXPECT_NE(message_of(parameters).find("joint 2"), std::string::npos);
  parameters = phantom().parameters();
  parameters.lower_limit_rad[2] = parameters.upper_limit_rad[2];
  EXPECT_NE(message_of(parameters).find("joint 3"), std::string::npos);
  parameters = phantom().parameters();
  parameters.max_q3_minus_q2_rad = -parameters.max_q2_minus_q3_rad;
  EXPECT_NE(message_of(parameters).find("limits.q3_minus_q2_rad"), std::string::npos);
}

TEST(LoadArm, NamesTheShippedArmAndItsSource) {
  EXPECT_EQ(phantom().parameters().name, "phantom-1.5");
  EXPECT_NE(phantom().parameters().source.find("Presence 11(6)"), std::string::npos);
}

TEST(LoadArm, ReadsAFileGivenByItsPath) {
  const auto file = altered_file("l1_m = 0.215", "l1_m = 0.25");
  EXPECT_DOUBLE_EQ(load_arm(file.string()).parameters().l1_m, 0.25);
}

TEST(LoadArm, NamesFileAndKeyOfAMissingParameter) {
  const auto file = altered_file("l3_m = 0.0325\n", "");
  const std::string message = message_of_file(file);
  EXPECT_NE(message.find(file.string() + ": geometry.l3_m is missing"), std::string::npos)
      << message;
}

TEST(LoadArm, NamesFileAndLineOfANegativeMass) {
  const auto file = altered_file("ma_kg = 0.0202", "ma_kg = -0.0202");
  const std::string message = message_of_file(file);
  EXPECT_NE(message.find(file.string() + ":"), std::string::npos) << message;
  EXPECT_NE(message.find("mass.ma_kg"), std::string::npos) << message;
}

TEST(LoadArm, NamesTheFileOfLimitsThatLeaveNoRoom) {
  const auto file = altered_file("q3_minus_q2_rad = 0.95", "q3_minus_q2_rad = -1.95");
  const std::string message = message_of_file(file);
  EXPECT_NE(message.find(file.string() + ": arm 'phantom-1.5'"), std::string::npos) << message;
}

TEST(LoadArm, NamesAnArmThatIsNowhere) {
  const std::string message = message_of_file("phantom-9.9");
  EXPECT_NE(message.find("arms/phantom-9.9.toml: no such file"), std::string::npos) << message;
  EXPECT_NE(message_of_file("nowhere.toml").find("nowhere.toml: no such file"), std::string::npos);
}

}  // namespace
}  // namespace teleop
