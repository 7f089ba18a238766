#include "core/recording/recorder.hpp"

#include <array>
#include <csignal>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "tests/recording/samples.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using testing::any_ticks;
using testing::begin_with;
using testing::plain_tick;
using testing::TemporaryFolder;

TEST(Recorder, WritesEveryRecordInOrder) {
  const TemporaryFolder folder;
  const auto ticks = any_ticks(1, 20'000);
  {
    Recorder recorder{{.log = {.file = folder.path() / "log.mcap"}, .ring_records = 1024}};
    for (const TickRecord& tick : ticks) {
      while (!recorder.record(tick)) {
        std::this_thread::yield();
      }
    }
    recorder.close({{"turns", "20000"}});
    EXPECT_FALSE(recorder.failed());
  }

  const Log log = read_log(folder.path() / "log.mcap");

  EXPECT_TRUE(log.complete) << log.damage;
  EXPECT_EQ(log.ticks.size(), ticks.size());
  EXPECT_TRUE(begin_with(ticks, log.ticks));
  EXPECT_EQ(log.metadata.at("turns"), "20000");
}

TEST(Recorder, CountsWhatAFullRingDropped) {
  const TemporaryFolder folder;
  constexpr std::uint64_t kTicks = 50'000;
  Recorder recorder{{.log = {.file = folder.path() / "log.mcap"}, .ring_records = 16}};
  std::uint64_t kept = 0;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    if (recorder.record(plain_tick(i))) ++kept;
  }
  recorder.close();

  const Log log = read_log(folder.path() / "log.mcap");

  EXPECT_LT(kept, kTicks);
  EXPECT_EQ(log.ticks.size(), kept);
  EXPECT_EQ(recorder.dropped(), kTicks - kept);
  EXPECT_EQ(log.metadata.at("dropped"), std::to_string(kTicks - kept));
}

TEST(Recorder, RecordsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const TemporaryFolder folder;
  Recorder recorder{{.log = {.file = folder.path() / "log.mcap"}, .ring_records = 64}};
  const TickRecord tick = plain_tick(1);

  const testing::NoAllocation guard;
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(recorder.record(tick));
  }

  EXPECT_EQ(guard.count(), 0U);
}

TEST(Recorder, ClosesOnceAndRecordsNothingAfterwards) {
  const TemporaryFolder folder;
  Recorder recorder{{.log = {.file = folder.path() / "log.mcap"}}};
  EXPECT_TRUE(recorder.record(plain_tick(0)));
  recorder.close();
  const auto size = std::filesystem::file_size(folder.path() / "log.mcap");

  EXPECT_FALSE(recorder.record(plain_tick(1)));
  recorder.close();

  EXPECT_EQ(std::filesystem::file_size(folder.path() / "log.mcap"), size);
}

TEST(Recorder, StampsMessagesWithUnixTime) {
  const TemporaryFolder folder;
  Recorder recorder{{.log = {.file = folder.path() / "log.mcap"}}};
  EXPECT_TRUE(recorder.record(plain_tick(0)));
  recorder.close();

  const Log log = read_log(folder.path() / "log.mcap");

  const auto offset = std::stoll(log.metadata.at("epoch_offset_ns"));
  EXPECT_NEAR(static_cast<double>(offset - wall_clock_offset_ns()), 0.0, 5e9);
}

/// The process may write files of at most `bytes` while this lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  FileSizeLimit(FileSizeLimit&&) = delete;
  FileSizeLimit& operator=(FileSizeLimit&&) = delete;
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(Recorder, EndsTheRecordingAndNotTheLoopWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  const auto ticks = any_ticks(2, 3000);
  Recorder recorder{{.log = {.file = path}}};
  {
    const FileSizeLimit full{300'000};
    for (const TickRecord& tick : ticks) {
      static_cast<void>(recorder.record(tick));
    }
    recorder.close();
  }

  ASSERT_TRUE(recorder.failed());
  EXPECT_EQ(recorder.failure(), path.string() + ": cannot be written any further: File too large");
  EXPECT_FALSE(recorder.record(ticks.front()));
  const Log log = read_log(path);
  EXPECT_FALSE(log.complete);
  EXPECT_GT(log.ticks.size(), 100U);
  EXPECT_TRUE(begin_with(ticks, log.ticks));
}

/// Records at 1 kHz for at most 5 s and writes a byte a tick into `progress`. The stamps stand
/// still: what the writer does must depend on its own clock alone.
[[noreturn]] void record_until_killed(const std::filesystem::path& log, int progress) {
  Recorder recorder{{.log = {.file = log}}};
  auto next = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; i < 5000; ++i) {
    if (!recorder.record({.tick = i}) || ::write(progress, ".", 1) != 1) _exit(1);
    next += std::chrono::milliseconds{1};
    std::this_thread::sleep_until(next);
  }
  _exit(1);
}

TEST(Recorder, LosesAtMostTheLast100MsWhenItsProcessIsKilled) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "log.mcap";
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) record_until_killed(path, pipe_ends[1]);
  close(pipe_ends[1]);

  std::size_t ticks = 0;
  const auto read_some = [&] {
    std::array<char, 256> dots{};
    const ssize_t got = read(pipe_ends[0], dots.data(), dots.size());
    if (got > 0) ticks += static_cast<std::size_t>(got);
    return got > 0;
  };
  while (ticks < 437 && read_some()) {
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  while (read_some()) {
  }
  close(pipe_ends[0]);

  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_GE(ticks, 437U);
  const Log log = read_log(path);
  EXPECT_FALSE(log.complete);
  EXPECT_GE(log.ticks.size() + 100, ticks);
  for (std::size_t i = 0; i < log.ticks.size(); ++i) {
    ASSERT_EQ(log.ticks[i].tick, i);
  }
}

}  // namespace
}  // namespace teleop
