#include "core/base/csv_table.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/diagnosis_input/made_runs.hpp"

namespace teleop {
namespace {

using testing::cases;

const std::vector<std::string> kWanted{"t_s", "q_rad"};

TEST(CsvTable, FindsColumnsByNameInAnyOrder) {
  const CsvTable table =
      parse_csv("q_rad, note ,t_s\r\n1.5, any text,0\r\n-2e-3,,0.001\r\n\r\n", "run.csv", kWanted);

  EXPECT_EQ(table.columns[0], (std::vector<double>{0.0, 0.001}));
  EXPECT_EQ(table.columns[1], (std::vector<double>{1.5, -2e-3}));
  EXPECT_EQ(table.ignored, std::vector<std::string>{"note"});
}

TEST(CsvTable, TakesAByteOrderMarkForNoPartOfAName) {
  EXPECT_EQ(parse_csv("\xef\xbb\xbft_s,q_rad\n0,1\n", "run.csv", kWanted).rows(), 1U);
}

/// Finite numbers of every size.
double any_number(Random& random) {
  while (true) {
    const auto number = std::bit_cast<double>(random.bits());
    if (std::isfinite(number)) return number;
  }
}

TEST(CsvTable, ReadsBackWhatWasWrittenBitByBit) {
  Random random{20};
  for (int n = 0; n < cases(200); ++n) {
    const std::size_t columns = 1 + random.bits() % 6;
    const std::size_t rows = 1 + random.bits() % 20;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < columns; ++i) {
      names.push_back(fmt::format("c{}", i));
    }
    std::vector<std::vector<double>> written(columns, std::vector<double>(rows));
    std::string text = fmt::format("{}", fmt::join(names, ",")) + '\n';
    for (std::size_t k = 0; k < rows; ++k) {
      for (std::size_t i = 0; i < columns; ++i) {
        written[i][k] = any_number(random);
        text += fmt::format("{}{}", written[i][k], i + 1 < columns ? "," : "\n");
      }
    }

    const CsvTable table = parse_csv(text, "any.csv", names);

    ASSERT_EQ(table.rows(), rows);
    for (std::size_t i = 0; i < columns; ++i) {
      for (std::size_t k = 0; k < rows; ++k) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(table.columns[i][k]),
                  std::bit_cast<std::uint64_t>(written[i][k]))
            << written[i][k];
      }
    }
  }
}

/// Any damage gives a table or a ConfigError, nothing else.
TEST(CsvTable, SurvivesAnyDamage) {
  const std::string sound = "t_s,q_rad\n0,1.25\n0.001,1.5\n0.002,1.75\n";
  Random random{21};
  for (int n = 0; n < cases(2000); ++n) {
    std::string text = sound;
    for (std::uint64_t hits = 1 + random.bits() % 3; hits > 0; --hits) {
      text[random.bits() % text.size()] = static_cast<char>(random.bits());
    }
    try {
      const CsvTable table = parse_csv(text, "run.csv", kWanted);
      EXPECT_EQ(table.columns[0].size(), table.columns[1].size());
      EXPECT_GT(table.rows(), 0U);
    } catch (const ConfigError& error) {
      EXPECT_TRUE(std::string{error.what()}.starts_with("run.csv:")) << error.what();
    }
  }
}

struct BadCsv {
  const char* name;
  const char* text;
  const char* place;  ///< begin of the message
  const char* words;  ///< in it
};

class BadTable : public ::testing::TestWithParam<BadCsv> {};

TEST_P(BadTable, IsNamedWithItsLine) {
  try {
    static_cast<void>(parse_csv(GetParam().text, "run.csv", kWanted));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(GetParam().place)) << message;
    EXPECT_NE(message.find(GetParam().words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All,
    BadTable,
    ::testing::Values(
        BadCsv{"Nothing", "", "run.csv:1:", "no head line"},
        BadCsv{"HeadOnly", "t_s,q_rad\n", "run.csv:1:", "empty"},
        BadCsv{"HeadAndBlankLine", "t_s,q_rad\n\n", "run.csv:1:", "empty"},
        BadCsv{"NoHead", "0,1\n0.001,1\n", "run.csv:1:", "head line is missing"},
        BadCsv{"MissingColumn", "t_s,q\n0,1\n", "run.csv:1:", "column q_rad is missing"},
        BadCsv{"ColumnTwice", "t_s,q_rad,q_rad\n0,1,1\n", "run.csv:1:", "q_rad is there twice"},
        BadCsv{"TwoHeads", "t_s,q_rad\n0,1\nt_s,q_rad\n0,1\n", "run.csv:3:", "second head line"},
        BadCsv{"TwoHeadsCrLf", "t_s,q_rad\r\n0,1\r\nt_s,q_rad\r\n", "run.csv:3:", "second head"},
        BadCsv{"NotANumber", "t_s,q_rad\n0,1\n0.001,nan\n", "run.csv:3:", "q_rad = 'nan'"},
        BadCsv{"Infinite", "t_s,q_rad\n0,inf\n", "run.csv:2:", "not a finite number"},
        BadCsv{"TooLarge", "t_s,q_rad\n0,1e999\n", "run.csv:2:", "not a finite number"},
        BadCsv{"Text", "t_s,q_rad\n0,1\n0.001,abc\n", "run.csv:3:", "q_rad = 'abc'"},
        BadCsv{"HalfANumber", "t_s,q_rad\n0,1.5x\n", "run.csv:2:", "q_rad = '1.5x'"},
        BadCsv{"EmptyCell", "t_s,q_rad\n0,\n", "run.csv:2:", "q_rad = ''"},
        BadCsv{"TooFewCells", "t_s,q_rad\n0,1\n0.001\n", "run.csv:3:", "1 cells"},
        BadCsv{"TooManyCells", "t_s,q_rad\n0,1,2\n", "run.csv:2:", "3 cells"},
        BadCsv{"CutOff", "t_s,q_rad\n0,1\n0.0", "run.csv:3:", "1 cells"},
        BadCsv{"BlankLineInside", "t_s,q_rad\n0,1\n\n0.001,1\n", "run.csv:3:", "1 cells"}),
    [](const auto& one) { return std::string{one.param.name}; });

TEST(CsvTable, NamesAFileThatIsNotThere) {
  EXPECT_THROW(static_cast<void>(read_csv("/no/such/run.csv", kWanted)), ConfigError);
}

}  // namespace
}  // namespace teleop
