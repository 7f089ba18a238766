#include "core/recording/log.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/recording/tick_codec.hpp"
#include "tests/recording/samples.hpp"

namespace teleop {
namespace {

using testing::any_ticks;
using testing::begin_with;
using testing::TemporaryFolder;

struct Record {
  Opcode opcode{};
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<Record> records_of(ByteView file) {
  std::vector<Record> records;
  McapCursor cursor{file};
  static_cast<void>(cursor.raw(kMcapMagic.size()));
  while (cursor.position() + kMcapMagic.size() < file.size()) {
    Record record{.begin = cursor.position()};
    record.opcode = static_cast<Opcode>(cursor.number<std::uint8_t>());
    static_cast<void>(cursor.sized<std::uint64_t>());
    record.end = cursor.position();
    records.push_back(record);
  }
  EXPECT_FALSE(cursor.failed());
  return records;
}

/// A closed log of few ticks in chunks of four, as bytes.
struct SmallLog {
  static constexpr std::size_t kTicksPerChunk = 4;

  explicit SmallLog(std::size_t size = 10) : ticks{any_ticks(5, size, 30)} {
    const TemporaryFolder folder;
    testing::write_log({.file = folder.path() / "small.mcap", .metadata = {{"arm", "none"}}},
                       ticks);
    bytes = testing::bytes_of_file(folder.path() / "small.mcap");
    records = records_of(bytes);
  }

  std::vector<TickRecord> ticks;
  Bytes bytes;
  std::vector<Record> records;
};

std::optional<Log> parsed(ByteView bytes) {
  try {
    return parse_log(bytes, "small.mcap");
  } catch (const RecordingError&) {
    return std::nullopt;
  }
}

std::string message_of(const std::filesystem::path& file) {
  try {
    static_cast<void>(read_log(file));
  } catch (const RecordingError& error) {
    return error.what();
  }
  return {};
}

TEST(Log, GivesBackEveryTickAndTheMetadata) {
  const TemporaryFolder folder;
  const auto ticks = any_ticks(6, 1000);
  testing::write_log({.file = folder.path() / "log.mcap",
                      .role = Role::slave,
                      .metadata = {{"arm", "phantom-1.5"}, {"empty", ""}},
                      .epoch_offset_ns = 1'700'000'000'000'000'000},
                     ticks);

  const Log log = read_log(folder.path() / "log.mcap");

  EXPECT_TRUE(log.complete) << log.damage;
  EXPECT_EQ(log.ticks.size(), ticks.size());
  EXPECT_TRUE(begin_with(ticks, log.ticks));
  EXPECT_EQ(log.metadata.at("arm"), "phantom-1.5");
  EXPECT_EQ(log.metadata.at("empty"), "");
  EXPECT_EQ(log.metadata.at("role"), "slave");
  EXPECT_EQ(log.metadata.at("epoch_offset_ns"), "1700000000000000000");
  EXPECT_EQ(log.metadata.at("records"), "1000");
}

TEST(Log, IsTheSameBytesForTheSameRecords) { EXPECT_EQ(SmallLog{}.bytes, SmallLog{}.bytes); }

TEST(Log, IsReadUpToTheLastWholeChunkWhereverItIsCutOff) {
  const SmallLog small;
  for (std::size_t size = kMcapMagic.size(); size < small.bytes.size(); ++size) {
    const auto chunks = std::ranges::count_if(small.records, [&](const Record& record) {
      return record.opcode == Opcode::chunk && record.end <= size;
    });
    const std::size_t expected =
        std::min(static_cast<std::size_t>(chunks) * SmallLog::kTicksPerChunk, small.ticks.size());

    const auto log = parsed(ByteView{small.bytes}.first(size));

    ASSERT_EQ(log.has_value(), expected > 0) << "cut at " << size;
    if (!log) continue;
    ASSERT_EQ(log->ticks.size(), expected) << "cut at " << size;
    ASSERT_TRUE(begin_with(small.ticks, log->ticks)) << "cut at " << size;
    ASSERT_FALSE(log->complete) << "cut at " << size;
    ASSERT_FALSE(log->damage.empty()) << "cut at " << size;
  }
}

TEST(Log, NeverHidesAFlippedBit) {
  SmallLog small;
  Random random{7};
  for (int i = 0; i < testing::cases(5'000); ++i) {
    const std::size_t at = random.bits() % small.bytes.size();
    const std::byte kept = small.bytes[at];
    small.bytes[at] ^= std::byte{1} << static_cast<int>(random.bits() % 8);

    const auto log = parsed(small.bytes);

    ASSERT_FALSE(log && log->complete) << "byte " << at;
    small.bytes[at] = kept;
  }
}

TEST(Log, LeavesOutADamagedChunkAndSaysSo) {
  SmallLog small;
  const auto chunk = std::ranges::find(small.records, Opcode::chunk, &Record::opcode);
  ASSERT_NE(chunk, small.records.end());
  small.bytes[chunk->end - 10] ^= std::byte{1};

  const Log log = parse_log(small.bytes, "small.mcap");

  EXPECT_FALSE(log.complete);
  EXPECT_EQ(log.ticks.size(), small.ticks.size() - SmallLog::kTicksPerChunk);
  EXPECT_EQ(log.ticks.front().tick, SmallLog::kTicksPerChunk);
  EXPECT_NE(log.damage.find("chunk at byte " + std::to_string(chunk->begin)), std::string::npos)
      << log.damage;
}

TEST(Log, TellsOfRecordsThatAreNoTicks) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  {
    McapWriter writer{path, {.topic = "/master", .schema_name = kTickMessage}};
    Bytes tick;
    encode_tick(testing::plain_tick(0), tick);
    writer.message(0, 0, tick);
    writer.message(1, 1, ByteView{tick}.first(tick.size() - 1));
    writer.finish();
  }

  const Log log = read_log(path);

  EXPECT_EQ(log.ticks.size(), 1U);
  EXPECT_FALSE(log.complete);
  EXPECT_EQ(log.damage, "1 records are no teleop.Tick");
}

TEST(Log, SurvivesLengthsThatLie) {
  SmallLog small{40};
  Random random{8};
  for (int i = 0; i < testing::cases(2'000); ++i) {
    Bytes bytes = small.bytes;
    for (int flips = 0; flips < 8; ++flips) {
      // The first bytes of a record: its length, counts and sizes.
      const Record& record = small.records[random.bits() % small.records.size()];
      const std::size_t at = record.begin + random.bits() % 60;
      if (at < bytes.size()) bytes[at] = static_cast<std::byte>(random.bits());
    }
    static_cast<void>(parsed(bytes));
  }
}

TEST(Log, DoesNotUnpackAChunkThatClaimsToBeHuge) {
  SmallLog small;
  for (const Record& record : small.records) {
    constexpr std::size_t kSizeAt = 9 + 2 * sizeof(std::uint64_t);
    if (record.opcode == Opcode::chunk) small.bytes[record.begin + kSizeAt + 5] = std::byte{1};
  }

  try {
    static_cast<void>(parse_log(small.bytes, "small.mcap"));
    FAIL() << "1 TiB a chunk was read";
  } catch (const RecordingError& error) {
    EXPECT_NE(std::string{error.what()}.find("larger than 16 MiB"), std::string::npos)
        << error.what();
  }
}

TEST(Log, NamesTheFileThatCannotBeRead) {
  const TemporaryFolder folder;
  const auto missing = folder.path() / "missing.mcap";
  const auto foreign = folder.path() / "foreign.mcap";
  const auto empty = folder.path() / "empty.mcap";
  testing::write_file(foreign, bytes_of("not a recording at all"));
  testing::write_log({.file = empty}, {});

  EXPECT_EQ(message_of(missing), missing.string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(message_of(foreign), foreign.string() + ": not a recording: it is no MCAP file");
  EXPECT_EQ(message_of(empty), empty.string() + ": holds no readable record");
}

TEST(Log, IsNeverWrittenOverAnExistingFile) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  testing::write_file(path, bytes_of("precious"));

  EXPECT_THROW((LogWriter{{.file = path}}), RecordingError);
  EXPECT_EQ(testing::bytes_of_file(path).size(), std::string{"precious"}.size());
}

TEST(Log, SaysWhereItCannotBeCreated) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "no-such-folder/log.mcap";
  try {
    const LogWriter writer{{.file = path}};
    FAIL() << "created " << path;
  } catch (const RecordingError& error) {
    EXPECT_EQ(error.what(), path.string() + ": cannot be created: No such file or directory");
  }
}

}  // namespace
}  // namespace teleop
