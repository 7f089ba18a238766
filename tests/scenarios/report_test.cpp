#include "scenarios/report.hpp"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/recording/log_writer.hpp"
#include "tests/reporting/run_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using testing::log_of;
using testing::TemporaryFolder;

std::string text_of(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

/// Two recordings of a run in a folder.
std::vector<std::string> record_pair(const TemporaryFolder& folder) {
  std::vector<std::string> files;
  for (const Role role : {Role::master, Role::slave}) {
    const Log log = log_of({.role = role, .seconds = 0.5, .position = testing::sine(0.05, 1.0)});
    const fs::path file = folder.path() / log.file;
    LogWriter writer{{.file = file, .role = role, .metadata = log.metadata}};
    for (const TickRecord& record : log.ticks) {
      writer.append(record);
    }
    writer.close({});
    files.push_back(file.string());
  }
  return files;
}

TEST(Report, OfTwoRecordingsIsAPageBesideThemAndNumbers) {
  const TemporaryFolder folder;
  const std::vector<std::string> logs = record_pair(folder);

  EXPECT_EQ(run_report(logs, "", folder.path() / "numbers.json"), 0);

  const auto numbers = nlohmann::json::parse(text_of(folder.path() / "numbers.json"));
  EXPECT_EQ(numbers["ticks"]["slave"], 501);
  EXPECT_EQ(numbers["recordings"], logs);
  EXPECT_EQ(numbers["report"], (folder.path() / "report.html").string());
  EXPECT_NE(text_of(folder.path() / "report.html").find("A clean run"), std::string::npos);
}

TEST(Report, RefusesToWriteOverARecordingWhateverItIsCalled) {
  const TemporaryFolder folder;
  const std::vector<std::string> logs{folder.write("master.mcap", "precious"),
                                      folder.write("slave.mcap", "precious too")};
  fs::create_symlink(logs[1], folder.path() / "link.html");
  const fs::path detour = folder.path() / "." / "master.mcap";
  const fs::path good = folder.path() / "report.html";

  EXPECT_THROW(run_report(logs, logs[0], ""), ConfigError);
  EXPECT_THROW(run_report(logs, detour, ""), ConfigError);
  EXPECT_THROW(run_report(logs, folder.path() / "link.html", ""), ConfigError);
  EXPECT_THROW(run_report(logs, good, logs[1]), ConfigError);
  EXPECT_THROW(run_report(logs, good, good), ConfigError);
  EXPECT_THROW(run_report(logs, folder.path() / "none" / "report.html", ""), ConfigError);
  EXPECT_THROW(run_report(logs, folder.path(), ""), ConfigError);

  EXPECT_EQ(text_of(logs[0]), "precious");
  EXPECT_EQ(text_of(logs[1]), "precious too");
  EXPECT_FALSE(fs::exists(good));
}

TEST(Report, OfTwoRecordingsOfOneSideSaysSo) {
  const TemporaryFolder folder;
  const std::vector<std::string> logs = record_pair(folder);
  EXPECT_THROW(run_report({logs[0], logs[0]}, "", ""), RecordingError);
  EXPECT_FALSE(fs::exists(folder.path() / "report.html"));
}

}  // namespace
}  // namespace teleop
