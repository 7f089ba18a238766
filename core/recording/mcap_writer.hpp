#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/recording/mcap_format.hpp"
#include "core/recording/output_file.hpp"

struct ZSTD_CCtx_s;

namespace teleop {

/// Writes an MCAP file of one channel: chunks compressed with zstd, CRCs, message and chunk index,
/// summary [MCAP]. A chunk reaches the operating system in one write as soon as it is closed, so
/// all but the open chunk outlives the process. The index in memory grows by 40 bytes a chunk.
///
/// Thread: one.
class McapWriter {
 public:
  /// Messages of a longer span, in log time, do not share a chunk.
  static constexpr Duration kChunkSpan = std::chrono::milliseconds{100};
  /// Nor do more bytes than these, before compression.
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;

  struct Channel {
    std::string topic{};
    std::string schema_name{};  ///< of the Protobuf message
    std::string schema{};       ///< serialised FileDescriptorSet
  };

  /// @throws RecordingError, like every function here: the file exists or cannot be written.
  McapWriter(const std::filesystem::path& file, Channel channel);
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;
  McapWriter(McapWriter&&) = delete;
  McapWriter& operator=(McapWriter&&) = delete;
  ~McapWriter();  ///< without finish() before, the file stays cut off

  void metadata(const std::string& name, const std::map<std::string, std::string>& entries);

  /// A message of `log_time_ns` into the open chunk, which the bytes in `data` do not outlive.
  void message(std::uint32_t sequence, std::uint64_t log_time_ns, ByteView data);

  /// Closes the open chunk, if it holds a message, and writes it.
  void write_chunk();

  /// Closes the file: data end, summary and footer. Nothing can be written afterwards.
  void finish();

  [[nodiscard]] std::uint64_t messages() const noexcept { return messages_; }

 private:
  struct IndexEntry {
    std::uint64_t log_time_ns = 0;
    std::uint64_t offset = 0;  ///< in the uncompressed chunk
  };
  struct Chunk {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::uint64_t offset = 0;  ///< in the file
    std::uint32_t length = 0;  ///< of the record
    std::uint32_t compressed = 0;
    std::uint32_t uncompressed = 0;
    std::uint32_t index_length = 0;  ///< of the message index record behind it
  };
  struct Place {
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
    std::string name{};
  };
  struct Group {
    Opcode opcode{};
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
  };
  template <class Content>
  void group(Opcode opcode, Content&& content);
  void put_schema();
  void put_channel();
  void put_chunk_index(const Chunk& chunk);
  void put_statistics();
  void put_footer(std::uint64_t summary_start, std::uint64_t offsets_start);
  void compress_chunk();
  void emit();
  [[nodiscard]] std::uint64_t position() const noexcept { return written_ + out_.size(); }

  struct FreeContext {
    void operator()(ZSTD_CCtx_s* context) const noexcept;
  };

  OutputFile file_;
  Channel channel_;
  std::unique_ptr<ZSTD_CCtx_s, FreeContext> zstd_;
  McapBuffer out_;    ///< not yet handed to the file
  McapBuffer chunk_;  ///< the open chunk, uncompressed
  Bytes compressed_;
  std::vector<IndexEntry> index_;  ///< of the open chunk
  std::deque<Chunk> chunks_;
  std::vector<Place> metadata_;
  std::vector<Group> groups_;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;  ///< of the section that is being written
  std::uint64_t messages_ = 0;
};

}  // namespace teleop
