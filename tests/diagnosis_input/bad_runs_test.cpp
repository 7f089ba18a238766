#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "tests/diagnosis_input/made_runs.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::kArmCase;
using testing::TemporaryFolder;

/// Damage done to a sound run of an arm, by line of its file.
struct BadRun {
  const char* name;
  void (*damage)(std::vector<std::string>& lines);
  const char* place;
  const char* words;
};

class BadRunFile : public ::testing::TestWithParam<BadRun> {};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// The run with every reading of a joint multiplied.
void scale_readings(std::vector<std::string>& lines, double factor) {
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::size_t comma = lines[k].rfind(',');
    const double q3_rad = std::stod(lines[k].substr(comma + 1));
    lines[k].replace(comma + 1, std::string::npos, fmt::format("{:.7f}", factor * q3_rad));
  }
}

TEST_P(BadRunFile, IsRefusedWithFileAndRow) {
  const TemporaryFolder folder;
  static_cast<void>(folder.write("case.toml", kArmCase));
  auto lines = lines_of(testing::csv_of(testing::made_run(testing::ideal_plant(), 3)));
  GetParam().damage(lines);
  std::string text;
  for (const std::string& line : lines) {
    text += line + '\n';
  }
  const auto file = folder.write("run-01.csv", text);
  try {
    refuse_fatal(audit(read_case(folder.path())));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(file.string() + GetParam().place)) << message;
    EXPECT_NE(message.find(GetParam().words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

using Lines = std::vector<std::string>;

INSTANTIATE_TEST_SUITE_P(
    All,
    BadRunFile,
    ::testing::Values(
        BadRun{"MissingColumn", [](Lines& l) { l[0].replace(l[0].find("q2_rad"), 6, "q2_deg"); },
               ":1: ", "column q2_rad is missing"},
        BadRun{"NaN", [](Lines& l) { l[16].replace(l[16].rfind(',') + 1, 99, "nan"); },
               ":17: ", "q3_rad = 'nan'"},
        BadRun{"WrongRate",
               [](Lines& l) {
                 for (std::size_t k = 1; 2 * k < l.size(); ++k) {
                   l[k] = l[2 * k];
                 }
                 l.resize(l.size() / 2);
               },
               ":3: ", "500 Hz"},
        BadRun{"TwoHeads", [](Lines& l) { l.insert(l.begin() + 9, l[0]); },
               ":10: ", "second head line"},
        BadRun{"EmptyRun", [](Lines& l) { l.resize(1); }, ":1: ", "empty"},
        BadRun{"OtherEncoder", [](Lines& l) { scale_readings(l, 1.0123); }, ":", "another arm"},
        BadRun{"Degrees", [](Lines& l) { scale_readings(l, 180.0 / std::numbers::pi); }, ":",
               "degrees"},
        BadRun{"MissingRows", [](Lines& l) { l.erase(l.begin() + 100, l.begin() + 140); },
               ":101: ", "rows are missing"},
        BadRun{"SameRowTwice", [](Lines& l) { l.insert(l.begin() + 200, l[200]); },
               ":202: ", "time must increase"}),
    [](const auto& one) { return std::string{one.param.name}; });

}  // namespace
}  // namespace teleop
