#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/recording/samples.hpp"

namespace teleop {
namespace {

using nlohmann::json;
using testing::TemporaryFolder;

constexpr const char* kHere = TELEOP_SOURCE_DIR "/tests/recording";

/// What a command prints, or nothing when it fails.
std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> part{};
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) {
    text.append(part.data(), got);
  }
  return pclose(pipe) == 0 ? text : std::string{};
}

/// What MCAP's reference library says of a file. Null when it refuses it.
json read_by_reference(const std::filesystem::path& log) {
  const std::string text =
      output_of(std::string{"node '"} + kHere + "/mcap_check.mjs' '" + log.string() + "'");
  return text.empty() ? json{} : json::parse(text);
}

class ReferenceLibrary : public ::testing::Test {
 protected:
  void SetUp() override {
    if (output_of("node --version 2>/dev/null").empty()) GTEST_SKIP() << "node is absent";
    if (!std::filesystem::exists(std::filesystem::path{kHere} / "node_modules")) {
      GTEST_SKIP() << "@mcap/core is absent: npm ci --prefix tests/recording";
    }
  }
};

/// Compares a record with the same fields in JSON.
struct ExpectSame {
  const json& fields;

  void operator()(const Field& field, std::uint64_t value) const {
    EXPECT_EQ(fields.at(field.name), std::to_string(value)) << field.name;
  }
  void operator()(const Field& field, std::int64_t value) const {
    EXPECT_EQ(fields.at(field.name), std::to_string(value)) << field.name;
  }
  void operator()(const Field& field, std::uint32_t value) const {
    EXPECT_EQ(fields.at(field.name).get<std::uint32_t>(), value) << field.name;
  }
  void operator()(const Field& field, double value) const {
    EXPECT_EQ(fields.at(field.name).get<double>(), value) << field.name;
  }
  void operator()(const Field& field, const auto& values) const {
    const json& numbers = fields.at(field.name);
    ASSERT_EQ(numbers.size(), kJoints) << field.name;
    for (auto number = numbers.begin(); const auto value : values) {
      EXPECT_EQ((number++)->get<double>(), value) << field.name;
    }
  }
};

TEST_F(ReferenceLibrary, ReadsEveryValueOfALogThroughItsIndex) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  const auto ticks = testing::any_ticks(1, 250);
  const std::int64_t offset = 1'700'000'000'000'000'000;
  testing::write_log({.file = path,
                      .role = Role::slave,
                      .metadata = {{"arm", "phantom-1.5"}},
                      .epoch_offset_ns = offset},
                     ticks);

  const json read = read_by_reference(path);

  ASSERT_FALSE(read.is_null());
  EXPECT_EQ(read["header"]["library"], "teleop");
  EXPECT_EQ(read["header"]["profile"], "");
  EXPECT_EQ(read["topics"], json({"/slave"}));
  EXPECT_EQ(read["metadata"]["teleop.start"]["arm"], "phantom-1.5");
  EXPECT_EQ(read["metadata"]["teleop.end"]["records"], "250");
  ASSERT_EQ(read["messages"].size(), ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const json& message = read["messages"][i];
    EXPECT_EQ(message["sequence"], i);
    EXPECT_EQ(message["log_time"], std::to_string(ticks[i].stamp_ns + offset));
    EXPECT_EQ(message["publish_time"], message["log_time"]);
    for_each_field(ticks[i], ExpectSame{message["fields"]});
  }
}

TEST_F(ReferenceLibrary, AgreesWithIndexSummaryAndCrcs) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  testing::write_log({.file = path}, testing::any_ticks(2, 250));

  const json read = read_by_reference(path);

  ASSERT_FALSE(read.is_null());
  EXPECT_EQ(read["chunks"], 3);
  EXPECT_EQ(read["groups"], 5);  // schema, channel, chunk index, metadata index, statistics
  EXPECT_EQ(read["statistics"], json({{"messages", "250"},
                                      {"chunks", 3},
                                      {"metadata", 2},
                                      {"start", "0"},
                                      {"end", "249000000"}}));
  EXPECT_EQ(read["crcs"], json({{"data", true}, {"summary", true}}));
  EXPECT_EQ(read["streamed"]["done"], true);
  EXPECT_EQ(read["streamed"]["records"]["Message"], 250);
  EXPECT_EQ(read["streamed"]["records"]["MessageIndex"], 3);
  EXPECT_EQ(read["streamed"]["records"]["SummaryOffset"], 5);
}

TEST_F(ReferenceLibrary, ReadsALogWithoutATick) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  testing::write_log({.file = path}, {});

  const json read = read_by_reference(path);

  ASSERT_FALSE(read.is_null());
  EXPECT_EQ(read["messages"].size(), 0U);
  EXPECT_EQ(read["statistics"]["end"], "0");
}

TEST_F(ReferenceLibrary, RefusesADamagedLog) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  testing::write_log({.file = path}, testing::any_ticks(3, 250));
  Bytes bytes = testing::bytes_of_file(path);
  bytes[bytes.size() / 2] ^= std::byte{1};
  testing::write_file(path, bytes);

  EXPECT_TRUE(read_by_reference(path).is_null());
}

}  // namespace
}  // namespace teleop
