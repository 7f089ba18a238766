#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/fault.hpp"

namespace teleop {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t from = 1; from < line.size();) {
    const std::size_t to = std::min(line.find('|', from), line.size());
    cells.push_back(trimmed(line.substr(from, to - from)));
    from = to + 1;
  }
  return cells;
}

/// The rows of docs/faults.md that begin with a number.
std::vector<std::vector<std::string>> documented() {
  std::ifstream in{TELEOP_SOURCE_DIR "/docs/faults.md"};
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    auto cells = cells_of(line);
    if (cells.front().find_first_not_of("0123456789") == std::string::npos) {
      rows.push_back(std::move(cells));
    }
  }
  return rows;
}

TEST(FaultTable, IsDocumentedRowByRow) {
  const auto rows = documented();
  const auto table = fault_table();
  ASSERT_EQ(rows.size(), table.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 5U) << rows[i].front();
    EXPECT_EQ(rows[i][0], std::to_string(table[i].code));
    EXPECT_EQ(rows[i][1], table[i].name);
    EXPECT_EQ(rows[i][2], table[i].cause);
    EXPECT_FALSE(rows[i][3].empty()) << table[i].name << ": what the machine does";
    EXPECT_FALSE(rows[i][4].empty()) << table[i].name << ": what to do";
  }
}

TEST(FaultTable, NamesEveryFaultAndLimit) {
  constexpr std::array kFaults{Fault::device_unplugged,     Fault::encoder_frozen,
                               Fault::state_not_finite,     Fault::device_watchdog,
                               Fault::joint_speed_exceeded, Fault::encoder_jump,
                               Fault::recording_failed,     Fault::peer_faulted};
  constexpr std::array kLimits{Limit::force,       Limit::torque,         Limit::slew,
                               Limit::joint_range, Limit::device_torque,  Limit::overrun,
                               Limit::peer_silent, Limit::record_dropped, Limit::workspace};
  EXPECT_EQ(kFaults.size() + kLimits.size(), fault_table().size());
  for (const Fault fault : kFaults)
    EXPECT_NE(name_of(fault), "none");
  for (const Limit limit : kLimits)
    EXPECT_NE(name_of(limit), "none");
  EXPECT_EQ(name_of(Fault::none), "none");
}

TEST(FaultTable, IsSortedByCodesThatAppearOnce) {
  const auto table = fault_table();
  EXPECT_TRUE(std::ranges::is_sorted(table, {}, &FaultText::code));
  EXPECT_EQ(std::ranges::adjacent_find(table, {}, &FaultText::code), table.end());
}

}  // namespace
}  // namespace teleop
