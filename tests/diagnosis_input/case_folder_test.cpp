#include "core/diagnosis/case_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/diagnosis/audit.hpp"
#include "tests/diagnosis_input/made_runs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::kArmCase;
using testing::TemporaryFolder;

constexpr const char* kBenchCase = R"(
case = "bench"
plant = "rigid-axes"
sample_rate_Hz = 1000
[[axis]]
name = "carriage"
motion = "prismatic"
position = "x_m"
inertia = "free"
gravity = "none"
[[axis]]
name = "arm"
motion = "revolute"
position = "phi_rad"
inertia = { value = 0.002, tolerance = 0.1 }
gravity = { kind = "pendulum", moment = 0.3 }
resolution = 1e-4
[[input]]
axis = "carriage"
column = "u_V"
role = "motor"
gain = 35.0
[[input]]
axis = "arm"
column = "tau_Nm"
role = "motor"
gain = "free"
[[input]]
axis = "arm"
column = "f_N"
role = "contact"
gain = { value = 0.5, tolerance = 0.2 }
[[run]]
file = "run.csv"
)";

constexpr const char* kBenchRun =
    "t_s,x_m,phi_rad,u_V,tau_Nm,f_N\n"
    "0.000,1,0.1,0.5,7,4\n0.001,2,0.2,1,8,6\n0.002,3,0.3,1.5,9,8\n0.003,4,0.4,2,10,10\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CaseFolder, ReadsTheRunsOfAnArm) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("case.toml", kArmCase));
  static_cast<void>(folder.write("run-01.csv",
                                 "q3_rad,q2_rad,t_s,tau1_Nm,tau2_Nm,i1_A,tau3_Nm,q1_rad\n"
                                 "3,2,0.000,10,20,9,30,1\n6,5,0.001,40,50,9,60,4\n"));

  const DiagnosisCase out = read_case(folder.path());

  EXPECT_EQ(out.name, "bench-7");
  EXPECT_EQ(out.axes(), 3U);
  EXPECT_DOUBLE_EQ(out.period_s, 1e-3);
  EXPECT_DOUBLE_EQ(out.command_step, 1e-5);
  EXPECT_DOUBLE_EQ(out.resolution[1], 2.0 * std::numbers::pi / 45875.2);
  ASSERT_EQ(out.runs.size(), 1U);
  const Recording& run = out.runs.front();
  EXPECT_EQ(run.name, "run-01.csv");
  EXPECT_EQ(run.excitation, "by hand");
  EXPECT_EQ(run.rows(), 2U);
  EXPECT_EQ(run.q[1], JointVector(4, 5, 6));
  EXPECT_EQ(run.tau[0], JointVector(10, 20, 30));
  EXPECT_EQ(run.t_s, (std::vector<double>{0.0, 0.001}));
  EXPECT_EQ(run.first_row, 2U);
  EXPECT_TRUE(run.contact.empty());
  EXPECT_EQ(run.notes, std::vector<std::string>{"not used: i1_A"});
}

TEST(CaseFolder, ReadsABenchInNewtonsAndNewtonMetres) {
  const TemporaryFolder folder;
  const auto file = folder.write("any-name.toml", kBenchCase);
  static_cast<void>(folder.write("run.csv", kBenchRun));

  const DiagnosisCase out = read_case(file);

  ASSERT_EQ(out.axes(), 2U);
  EXPECT_TRUE(out.bench[0].prismatic);
  EXPECT_FALSE(out.bench[0].inertia);
  EXPECT_FALSE(out.bench[0].free_gain);
  EXPECT_DOUBLE_EQ(out.bench[1].inertia.value_or(0.0), 0.002);
  EXPECT_DOUBLE_EQ(out.bench[1].inertia_tolerance, 0.1);
  EXPECT_TRUE(out.bench[1].pendulum);
  EXPECT_DOUBLE_EQ(out.bench[1].moment.value_or(0.0), 0.3);
  EXPECT_TRUE(out.bench[1].free_gain);
  EXPECT_EQ(out.bench[1].contact_column, "f_N");
  EXPECT_DOUBLE_EQ(out.bench[1].contact_tolerance, 0.2);
  EXPECT_EQ(out.resolution, JointVector(0.0, 1e-4, 0.0));
  const Recording& run = out.runs.front();
  EXPECT_EQ(run.q[1], JointVector(2, 0.2, 0));
  EXPECT_EQ(run.tau[1], JointVector(35, 8, 0));
  EXPECT_EQ(run.contact[1], JointVector(0, 3, 0));
}

TEST(CaseFolder, AddsUpTheInputsOfAnAxis) {
  const TemporaryFolder folder;
  static_cast<void>(
      folder.write("case.toml", replaced(kBenchCase, "[[run]]",
                                         "[[input]]\naxis = \"carriage\"\ncolumn = \"tau_Nm\"\n"
                                         "role = \"motor\"\ngain = -2.0\n[[run]]")));
  static_cast<void>(folder.write("run.csv", kBenchRun));

  const DiagnosisCase out = read_case(folder.path());

  EXPECT_EQ(out.bench[0].motor_column, "u_V + tau_Nm");
  EXPECT_EQ(out.runs.front().tau[0], JointVector(35.0 * 0.5 - 2.0 * 7.0, 7, 0));
}

TEST(CaseFolder, WindowsOfAFileAreRunsThatShareNoRow) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write(
      "case.toml",
      std::string{kBenchCase} +
          "stop_s = 0.001\n[[run]]\nfile = \"run.csv\"\nstart_s = 0.001\nheld_out = true\n"));
  static_cast<void>(folder.write("run.csv", kBenchRun));

  const DiagnosisCase out = read_case(folder.path());

  ASSERT_EQ(out.runs.size(), 2U);
  EXPECT_EQ(out.runs[0].rows(), 1U);
  EXPECT_EQ(out.runs[1].rows(), 3U);
  EXPECT_EQ(out.runs[1].q[0], JointVector(2, 0.2, 0));
  EXPECT_EQ(out.runs[1].first_row, 3U);
  EXPECT_TRUE(out.runs[1].held_out);
  EXPECT_NE(out.runs[0].name, out.runs[1].name);
}

TEST(CaseFolder, FindsTheRecordingsInAFolderOfTheirOwn) {
  const TemporaryFolder cases;
  const TemporaryFolder data;
  static_cast<void>(cases.write("case.toml", kBenchCase));
  static_cast<void>(data.write("run.csv", kBenchRun));

  EXPECT_EQ(read_case(cases.path(), data.path()).runs.front().rows(), 4U);
  EXPECT_THROW(static_cast<void>(read_case(cases.path())), ConfigError);
}

TEST(CaseFolder, ReadsBackARunThatWasWritten) {
  const TemporaryFolder folder;
  const Recording run = testing::made_run(testing::ideal_plant(), 1, {.seconds = 1.0});
  static_cast<void>(folder.write("case.toml", kArmCase));
  static_cast<void>(folder.write("run-01.csv", testing::csv_of(run)));

  const Recording read = read_case(folder.path()).runs.front();

  ASSERT_EQ(read.rows(), run.rows());
  for (std::size_t k = 0; k < run.rows(); ++k) {
    ASSERT_LT((read.q[k] - run.q[k]).cwiseAbs().maxCoeff(), 0.51e-7);
    ASSERT_LT((read.tau[k] - run.tau[k]).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// --- what cannot be used

struct BadCase {
  const char* name;
  const char* base;  ///< case text
  const char* from;  ///< in it
  const char* to;
  const char* words;  ///< in the message
};

class BadCaseFile : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadCaseFile, IsNamedWithItsLine) {
  const TemporaryFolder folder;
  const BadCase& bad = GetParam();
  static_cast<void>(folder.write("case.toml", replaced(bad.base, bad.from, bad.to)));
  static_cast<void>(folder.write("run.csv", kBenchRun));
  static_cast<void>(folder.write("run-01.csv",
                                 "t_s,tau1_Nm,tau2_Nm,tau3_Nm,q1_rad,q2_rad,q3_rad\n"
                                 "0,0,0,0,0,0,0\n0.001,0,0,0,0,0,0\n"));
  try {
    static_cast<void>(read_case(folder.path()));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with((folder.path() / "case.toml").string() + ":")) << message;
    EXPECT_NE(message.find(bad.words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All,
    BadCaseFile,
    ::testing::Values(
        BadCase{"NotToml", kArmCase, "case = ", "case ", ":2: not TOML"},
        BadCase{"UnknownPlant", kArmCase, "phantom-1.5", "phantom-9", ":3: plant = \"phantom-9\""},
        BadCase{"NoPlant", kArmCase, "plant = \"phantom-1.5\"", "", "plant is missing"},
        BadCase{"NoRate", kArmCase, "sample_rate_Hz = 1000", "", "sample_rate_Hz is missing"},
        BadCase{"RateZero", kArmCase, "= 1000", "= 0", ":4: sample_rate_Hz must be more than 0"},
        BadCase{"RateInWords", kArmCase, "= 1000", "= \"fast\"", "must be a number"},
        BadCase{"UnknownKey", kArmCase, "torque_convention", "torque_sign", ":5: unknown key 'tor"},
        BadCase{"UnknownRunKey", kArmCase, "excitation", "exitation", ":10: unknown key 'exit"},
        BadCase{"TwoCounts", kArmCase, "[54476.8, ", "[", ":6: encoder_counts"},
        BadCase{"NegativeCounts", kArmCase, "[5", "[-5", ":6: encoder_counts"},
        BadCase{"NoRun", kArmCase, "[[run]]\nfile = \"run-01.csv\"\nexcitation = \"by hand\"", "",
                "no [[run]]"},
        BadCase{"RunIsATable", kArmCase, "[[run]]", "[run]", ":8: run must be written as [[run]]"},
        BadCase{"NoFile", kArmCase, "file = \"run-01.csv\"", "", "file is missing"},
        BadCase{"FileNotThere", kArmCase, "run-01.csv", "run-02.csv", ":9: "},
        BadCase{"SameRunTwice", kBenchCase, "[[run]]", "[[run]]\nfile = \"run.csv\"\n[[run]]",
                "run.csv is there twice"},
        BadCase{"AllHeldOut", kBenchCase, "\"run.csv\"", "\"run.csv\"\nheld_out = true",
                "every run is held out"},
        BadCase{"HeldOutInWords", kBenchCase, "\"run.csv\"", "\"run.csv\"\nheld_out = \"yes\"",
                "held_out must be true or false"},
        BadCase{"EmptyWindow", kBenchCase, "\"run.csv\"", "\"run.csv\"\nstart_s = 5.0",
                "run.csv has no row"},
        BadCase{"WindowReversed", kBenchCase, "\"run.csv\"",
                "\"run.csv\"\nstart_s = 2.0\nstop_s = 1.0", "stop_s must be larger"},
        BadCase{"UnknownAxis", kBenchCase, "axis = \"arm\"", "axis = \"leg\"", "no such axis"},
        BadCase{"UnknownRole", kBenchCase, "\"contact\"", "\"touch\"", "role must be"},
        BadCase{"UnknownMotion", kBenchCase, "\"prismatic\"", "\"linear\"", ":7: motion must be"},
        BadCase{"UnknownGravity", kBenchCase, "gravity = \"none\"", "gravity = \"down\"",
                "gravity must be"},
        BadCase{"UnknownAxisKey", kBenchCase, "resolution", "resolutoin",
                "unknown key 'resolutoin'"},
        BadCase{"NegativeInertia", kBenchCase, "value = 0.002", "value = -0.002",
                "value must be more than 0"},
        BadCase{"InertiaInWords", kBenchCase, "\"free\"", "\"heavy\"", ":9: inertia must be"},
        BadCase{"BothFree", kBenchCase, "35.0", "\"free\"", "carriage: inertia and gain are both"},
        BadCase{"GainZero", kBenchCase, "35.0", "0.0", "gain must not be 0"},
        BadCase{"FreeContact", kBenchCase, "{ value = 0.5, tolerance = 0.2 }", "\"free\"",
                "a contact input needs a gain"},
        BadCase{"TwoUncertainGains", kBenchCase, "[[run]]",
                "[[input]]\naxis = \"arm\"\ncolumn = \"u_V\"\nrole = \"contact\"\ngain = 1.0\n"
                "[[run]]",
                "arm has several contact inputs"},
        BadCase{"AxisTwice", kBenchCase, "name = \"arm\"", "name = \"carriage\"",
                "carriage is there twice"},
        BadCase{"NothingMovesIt", kBenchCase,
                "[[input]]\naxis = \"carriage\"\ncolumn = \"u_V\"\nrole = \"motor\"\ngain = 35.0",
                "", "carriage has no [[input]]"}),
    [](const auto& one) { return std::string{one.param.name}; });

/// Any damage gives a case or one line that begins with the file, nothing else.
TEST(CaseFolder, SurvivesAnyDamageToTheCaseFile) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("run.csv", kBenchRun));
  Random random{30};
  for (int n = 0; n < testing::cases(500); ++n) {
    std::string text = kBenchCase;
    for (std::uint64_t hits = 1 + random.bits() % 3; hits > 0; --hits) {
      const std::size_t at = random.bits() % text.size();
      if (random.bits() % 2 == 0) {
        text[at] = static_cast<char>(random.bits() % 128);
      } else {
        text.erase(at, random.bits() % 20);
      }
    }
    const auto file = folder.write("case.toml", text);
    try {
      EXPECT_GT(read_case(file).runs.size(), 0U);
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with(folder.path().string())) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

TEST(CaseFolder, NamesAFolderWithoutACase) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_case(folder.path())), ConfigError);
  EXPECT_THROW(static_cast<void>(read_case(folder.path() / "none")), ConfigError);
}

// --- the examples

TEST(CaseFolder, ShippedCasesReadTheRealRecordings) {
  struct Example {
    const char* file;
    const char* data;
    std::size_t runs;
    std::size_t held_out;
  };
  const std::array examples{Example{"emps.toml", "recordings/emps", 2, 1},
                            Example{"emps-reversed.toml", "recordings/emps", 2, 1},
                            Example{"eindhoven-law-a.toml", "recordings/tue-bilateral", 12, 8},
                            Example{"eindhoven-law-c.toml", "recordings/tue-bilateral", 12, 8},
                            Example{"eindhoven-law-d.toml", "recordings/tue-bilateral", 12, 8}};
  if (!std::filesystem::exists(testing::shared("recordings"))) {
    GTEST_SKIP() << "the recordings are not here";
  }
  for (const Example& example : examples) {
    const auto file = std::filesystem::path{TELEOP_SOURCE_DIR} / "scenarios/cases" / example.file;
    const DiagnosisCase out = read_case(file, testing::shared(example.data));
    EXPECT_EQ(out.runs.size(), example.runs) << example.file;
    const auto held_out = std::count_if(out.runs.begin(), out.runs.end(),
                                        [](const Recording& run) { return run.held_out; });
    EXPECT_EQ(static_cast<std::size_t>(held_out), example.held_out) << example.file;
    for (const Finding& finding : audit(out).findings) {
      EXPECT_EQ(finding.severity, Severity::note) << line_of(finding);
    }
  }
}

}  // namespace
}  // namespace teleop
