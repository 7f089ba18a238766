#pragma once

#include <cstdint>
#include <filesystem>

#include "core/ports/peer.hpp"
#include "core/recording/log.hpp"
#include "core/recording/mcap_writer.hpp"

namespace teleop {

/// Writes the recording of one side, record by record and at once: what a run on simulated time
/// wants. The same records give the same bytes. A loop in real time uses a Recorder instead.
///
/// Thread: one. Loop: never.
class LogWriter {
 public:
  struct Config {
    std::filesystem::path file{};
    Role role = Role::master;          ///< the topic is /master or /slave
    Metadata metadata{};               ///< written first
    std::int64_t epoch_offset_ns = 0;  ///< Unix time − monotonic time, added to the stamps for
                                       ///< the message's log time; kept in the metadata
  };

  /// @throws RecordingError, like every function here: the file exists or cannot be written.
  explicit LogWriter(const Config& config);

  void append(const TickRecord& record);

  /// Hands everything appended to the operating system.
  void flush() { mcap_.write_chunk(); }

  /// Adds last words to the metadata and writes index and footer. Without it the log is cut off:
  /// readable, and told so.
  void close(Metadata last = {});

  [[nodiscard]] std::uint64_t records() const noexcept { return mcap_.messages(); }

 private:
  McapWriter mcap_;
  std::int64_t epoch_offset_ns_;
  Bytes message_;
};

}  // namespace teleop
