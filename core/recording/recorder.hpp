#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>

#include "core/base/time.hpp"
#include "core/realtime/ring.hpp"
#include "core/recording/log_writer.hpp"

namespace teleop {

/// Unix time minus monotonic time, now.
[[nodiscard]] std::int64_t wall_clock_offset_ns();

/// Records one side of a loop that runs in real time: the loop puts records into a ring, a thread
/// of ordinary priority drains it every 10 ms and writes a chunk every 40 ms. So a record is with
/// the operating system 50 ms after it was taken, and killing the process loses less than 100 ms. A
/// disk that fails ends the recording and never the loop.
///
/// Thread: record() by the loop alone, everything else by the thread that made it.
/// Loop: record(), dropped() and failed() neither allocate, block nor throw.
class Recorder {
 public:
  struct Config {
    LogWriter::Config log;            ///< epoch_offset_ns is set by the Recorder
    std::size_t ring_records = 4096;  ///< a power of two; 4 s at 1 kHz, 3 MB
  };

  static constexpr Duration kDrainEvery = std::chrono::milliseconds{10};
  static constexpr int kDrainsPerChunk = 4;

  /// @throws RecordingError: the file exists or cannot be created.
  explicit Recorder(Config config);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  Recorder(Recorder&&) = delete;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder();  ///< closes

  /// @returns false when the record is lost: the ring was full, or the recording failed or closed.
  bool record(const TickRecord& record) noexcept;

  /// Writes what is in the ring, last words of metadata, index and footer. Once is enough.
  void close(Metadata last = {});

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(); }

  /// The recording has ended before its time; failure() says why.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  /// @pre failed().
  [[nodiscard]] const std::string& failure() const;

 private:
  void write();
  void drain();
  void fail(const char* what);

  LogWriter log_;
  Ring<TickRecord> ring_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> failed_{false};
  std::atomic<bool> closing_{false};
  std::string failure_;  ///< written once, before failed_
  Metadata last_;        ///< written once, before closing_
  std::thread writer_;
};

}  // namespace teleop
