#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/recording/csv.hpp"
#include "core/recording/recover.hpp"
#include "tests/recording/samples.hpp"

namespace teleop {
namespace {

using testing::any_ticks;
using testing::begin_with;
using testing::TemporaryFolder;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream{text};
  for (std::string part; std::getline(stream, part, separator);) {
    parts.push_back(part);
  }
  return parts;
}

TEST(Csv, NamesAColumnForEveryNumber) {
  Log log{};
  log.ticks.emplace_back().arm_flags = static_cast<std::uint32_t>(ArmFlag::has_acceleration);
  std::ostringstream out;
  export_csv(log, out);

  const std::string head = split(out.str(), '\n').at(0);
  const auto names = split(head, ',');

  EXPECT_EQ(names.size(), testing::bits_of(TickRecord{}).size());
  EXPECT_EQ(names.front(), "tick");
  for (const char* name :
       {"stamp_ns", "counts[0]", "counts[2]", "q_rad[0]", "q_rad[1]", "p_m[2]"}) {
    EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
  }
  EXPECT_EQ(names.back(), "tool_acceleration_m_per_s2[2]");
}

TEST(Csv, LeavesOutTheAccelerometerThatNoTickHas) {
  Log log{};
  log.ticks.push_back(testing::plain_tick(3));
  std::ostringstream out;
  export_csv(log, out);

  const auto lines = split(out.str(), '\n');

  EXPECT_EQ(lines.at(0).find("tool_acceleration"), std::string::npos);
  EXPECT_TRUE(lines.at(0).ends_with(",packets_reordered"));
  EXPECT_EQ(split(lines.at(1), ',').size(), split(lines.at(0), ',').size());
}

/// Sets a record's numbers from the cells of a line.
struct FromCells {
  std::vector<std::string> cells;
  std::size_t next = 0;

  void operator()(const Field&, std::int64_t& value) { value = std::stoll(cells.at(next++)); }
  void operator()(const Field&, std::uint64_t& value) { value = std::stoull(cells.at(next++)); }
  void operator()(const Field&, std::uint32_t& value) {
    value = static_cast<std::uint32_t>(std::stoul(cells.at(next++)));
  }
  void operator()(const Field&, double& value) {
    value = std::strtod(cells.at(next++).c_str(), nullptr);  // stod refuses subnormal numbers
  }
  void operator()(const Field& field, auto& values) {
    for (auto& value : values) {
      if constexpr (std::integral<std::remove_cvref_t<decltype(value)>>) {
        value = std::stoi(cells.at(next++));
      } else {
        (*this)(field, value);
      }
    }
  }
};

TEST(Csv, ReadsBackToTheSameBits) {
  Log log{};
  log.ticks = any_ticks(1, 100);
  std::ostringstream out;
  export_csv(log, out);

  const auto lines = split(out.str(), '\n');

  ASSERT_EQ(lines.size(), 1 + log.ticks.size());
  for (std::size_t i = 0; i < log.ticks.size(); ++i) {
    TickRecord read;
    FromCells cells{.cells = split(lines[1 + i], ',')};
    for_each_field(read, cells);
    EXPECT_EQ(cells.next, cells.cells.size());
    ASSERT_EQ(testing::bits_of(read), testing::bits_of(log.ticks[i])) << "line " << i;
  }
}

/// A log of 500 ticks in chunks of 100, without an end.
std::vector<TickRecord> write_cut_off_log(const std::filesystem::path& path) {
  const auto ticks = any_ticks(2, 500);
  LogWriter writer{{.file = path, .metadata = {{"arm", "none"}}}};
  for (const TickRecord& tick : ticks) {
    writer.append(tick);
  }
  writer.flush();
  return ticks;
}

TEST(Recover, ClosesALogThatWasCutOff) {
  const TemporaryFolder folder;
  const auto in = folder.path() / "log.mcap";
  const auto out = recovered_name(in);
  const auto ticks = write_cut_off_log(in);
  Bytes torn = testing::bytes_of_file(in);
  const Bytes whole = torn;
  torn.resize(torn.size() - 2000);
  testing::write_file(in, torn);

  const Recovery recovery = recover_log(in, out);

  EXPECT_EQ(out.filename(), "log.recovered.mcap");
  EXPECT_EQ(recovery.kept, 400U);
  EXPECT_EQ(recovery.lost, 0U);
  EXPECT_GT(recovery.unread_bytes, 0U);
  EXPECT_EQ(testing::bytes_of_file(in), torn);
  const Log log = read_log(out);
  EXPECT_TRUE(log.complete) << log.damage;
  EXPECT_EQ(log.ticks.size(), 400U);
  EXPECT_TRUE(begin_with(ticks, log.ticks));
  EXPECT_EQ(log.metadata.at("arm"), "none");
  EXPECT_EQ(log.metadata.at("recovered_from"), "log.mcap");
  EXPECT_EQ(log.metadata.at("damage"), recovery.damage);
}

TEST(Recover, CountsTheRecordsOfADamagedChunk) {
  const TemporaryFolder folder;
  const auto in = folder.path() / "log.mcap";
  write_cut_off_log(in);
  Bytes bytes = testing::bytes_of_file(in);
  bytes[bytes.size() / 2] ^= std::byte{1};
  testing::write_file(in, bytes);

  const Recovery recovery = recover_log(in, folder.path() / "out.mcap");

  EXPECT_EQ(recovery.kept, 400U);
  EXPECT_EQ(recovery.lost, 100U);
  EXPECT_EQ(read_log(folder.path() / "out.mcap").ticks.size(), 400U);
}

TEST(Recover, WritesOverNothing) {
  const TemporaryFolder folder;
  const auto in = folder.path() / "log.mcap";
  write_cut_off_log(in);
  const Bytes before = testing::bytes_of_file(in);

  EXPECT_THROW(recover_log(in, in), RecordingError);
  EXPECT_EQ(testing::bytes_of_file(in), before);
}

TEST(Recover, CreatesNothingWhenNothingIsReadable) {
  const TemporaryFolder folder;
  const auto in = folder.path() / "log.mcap";
  {
    const LogWriter writer{{.file = in}};
  }

  EXPECT_THROW(recover_log(in, folder.path() / "out.mcap"), RecordingError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.mcap"));
}

}  // namespace
}  // namespace teleop
