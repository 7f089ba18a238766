#include "core/recording/mcap_writer.hpp"

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <zstd.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr std::uint16_t kSchema = 1;
constexpr std::uint16_t kChannel = 1;
constexpr int kCompressionLevel = 1;
constexpr std::size_t kPiece = std::size_t{1} << 16U;  ///< of a summary that is written in pieces
constexpr const char* kCompression = "zstd";

}  // namespace

void McapWriter::FreeContext::operator()(ZSTD_CCtx_s* context) const noexcept {
  ZSTD_freeCCtx(context);
}

McapWriter::McapWriter(const std::filesystem::path& file, Channel channel)
    : file_{file}, channel_{std::move(channel)}, zstd_{ZSTD_createCCtx()} {
  if (!zstd_) throw std::bad_alloc{};
  out_.raw(kMcapMagic);
  out_.record(Opcode::header, [&] {
    out_.text("");  // profile
    out_.text("teleop");
  });
  put_schema();
  put_channel();
  emit();
}

McapWriter::~McapWriter() = default;

void McapWriter::metadata(const std::string& name,
                          const std::map<std::string, std::string>& entries) {
  const std::uint64_t offset = position();
  out_.record(Opcode::metadata, [&] {
    out_.text(name);
    out_.map(entries);
  });
  metadata_.push_back({.offset = offset, .length = position() - offset, .name = name});
  emit();
}

void McapWriter::message(std::uint32_t sequence, std::uint64_t log_time_ns, ByteView data) {
  constexpr auto kSpan = static_cast<std::uint64_t>(kChunkSpan.count());
  if (!index_.empty() &&
      (log_time_ns - index_.front().log_time_ns >= kSpan || chunk_.size() >= kChunkBytes)) {
    write_chunk();  // a time that steps back is a huge difference and closes the chunk, too
  }
  index_.push_back({.log_time_ns = log_time_ns, .offset = chunk_.size()});
  chunk_.record(Opcode::message, [&] {
    chunk_.number(kChannel);
    chunk_.number(sequence);
    chunk_.number(log_time_ns);
    chunk_.number(log_time_ns);  // published when logged
    chunk_.raw(data);
  });
  ++messages_;
}

void McapWriter::write_chunk() {
  if (index_.empty()) return;
  const auto [first, last] = std::ranges::minmax(index_, {}, &IndexEntry::log_time_ns);
  compress_chunk();

  Chunk chunk{.first_ns = first.log_time_ns, .last_ns = last.log_time_ns, .offset = position()};
  chunk.compressed = static_cast<std::uint32_t>(compressed_.size());
  chunk.uncompressed = static_cast<std::uint32_t>(chunk_.size());
  out_.record(Opcode::chunk, [&] {
    out_.number(chunk.first_ns);
    out_.number(chunk.last_ns);
    out_.number(std::uint64_t{chunk.uncompressed});
    out_.number(crc32_of(chunk_.view()));
    out_.text(kCompression);
    out_.sized<std::uint64_t>([&] { out_.raw(compressed_); });
  });
  chunk.length = static_cast<std::uint32_t>(position() - chunk.offset);
  out_.record(Opcode::message_index, [&] {
    out_.number(kChannel);
    out_.sized<std::uint32_t>([&] {
      for (const IndexEntry& entry : index_) {
        out_.number(entry.log_time_ns);
        out_.number(entry.offset);
      }
    });
  });
  chunk.index_length = static_cast<std::uint32_t>(position() - chunk.offset - chunk.length);

  chunks_.push_back(chunk);
  chunk_.clear();
  index_.clear();
  emit();
}

void McapWriter::finish() {
  write_chunk();
  out_.record(Opcode::data_end, [&] { out_.number(crc_); });
  emit();

  crc_ = 0;
  const std::uint64_t summary_start = position();
  group(Opcode::schema, [&] { put_schema(); });
  group(Opcode::channel, [&] { put_channel(); });
  group(Opcode::chunk_index, [&] {
    for (const Chunk& chunk : chunks_) {
      put_chunk_index(chunk);
      if (out_.size() > kPiece) emit();
    }
  });
  group(Opcode::metadata_index, [&] {
    for (const Place& place : metadata_) {
      out_.record(Opcode::metadata_index, [&] {
        out_.number(place.offset);
        out_.number(place.length);
        out_.text(place.name);
      });
    }
  });
  group(Opcode::statistics, [&] { put_statistics(); });

  const std::uint64_t offsets_start = position();
  for (const Group& group : groups_) {
    out_.record(Opcode::summary_offset, [&] {
      out_.number(static_cast<std::uint8_t>(group.opcode));
      out_.number(group.offset);
      out_.number(group.length);
    });
  }
  put_footer(summary_start, offsets_start);
  emit();
}

template <class Content>
void McapWriter::group(Opcode opcode, Content&& content) {
  const std::uint64_t offset = position();
  content();
  if (position() == offset) return;
  groups_.push_back({.opcode = opcode, .offset = offset, .length = position() - offset});
}

void McapWriter::put_schema() {
  out_.record(Opcode::schema, [&] {
    out_.number(kSchema);
    out_.text(channel_.schema_name);
    out_.text("protobuf");
    out_.text(channel_.schema);
  });
}

void McapWriter::put_channel() {
  out_.record(Opcode::channel, [&] {
    out_.number(kChannel);
    out_.number(kSchema);
    out_.text(channel_.topic);
    out_.text("protobuf");
    out_.map({});
  });
}

void McapWriter::put_chunk_index(const Chunk& chunk) {
  out_.record(Opcode::chunk_index, [&] {
    out_.number(chunk.first_ns);
    out_.number(chunk.last_ns);
    out_.number(chunk.offset);
    out_.number(std::uint64_t{chunk.length});
    out_.sized<std::uint32_t>([&] {
      out_.number(kChannel);
      out_.number(chunk.offset + chunk.length);
    });
    out_.number(std::uint64_t{chunk.index_length});
    out_.text(kCompression);
    out_.number(std::uint64_t{chunk.compressed});
    out_.number(std::uint64_t{chunk.uncompressed});
  });
}

void McapWriter::put_statistics() {
  std::uint64_t first = chunks_.empty() ? 0 : std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last = 0;
  for (const Chunk& chunk : chunks_) {
    first = std::min(first, chunk.first_ns);
    last = std::max(last, chunk.last_ns);
  }
  out_.record(Opcode::statistics, [&] {
    out_.number(messages_);
    out_.number(std::uint16_t{1});  // schemas
    out_.number(std::uint32_t{1});  // channels
    out_.number(std::uint32_t{0});  // attachments
    out_.number(static_cast<std::uint32_t>(metadata_.size()));
    out_.number(static_cast<std::uint32_t>(chunks_.size()));
    out_.number(first);
    out_.number(last);
    out_.sized<std::uint32_t>([&] {
      out_.number(kChannel);
      out_.number(messages_);
    });
  });
}

void McapWriter::put_footer(std::uint64_t summary_start, std::uint64_t offsets_start) {
  out_.record(Opcode::footer, [&] {
    out_.number(summary_start);
    out_.number(offsets_start);
    out_.number(std::uint32_t{0});  // the CRC of all before it, this record's opcode included
  });
  const std::size_t crc_at = out_.size() - sizeof(std::uint32_t);
  const std::uint32_t crc = crc32_of(out_.view().first(crc_at), crc_);
  std::memcpy(out_.bytes().data() + crc_at, &crc, sizeof(crc));
  out_.raw(kMcapMagic);
}

void McapWriter::compress_chunk() {
  compressed_.resize(ZSTD_compressBound(chunk_.size()));
  const std::size_t size =
      ZSTD_compressCCtx(zstd_.get(), compressed_.data(), compressed_.size(), chunk_.view().data(),
                        chunk_.size(), kCompressionLevel);
  if (ZSTD_isError(size) != 0) {
    throw RecordingError{fmt::format("a chunk cannot be compressed: {}", ZSTD_getErrorName(size))};
  }
  compressed_.resize(size);
}

void McapWriter::emit() {
  file_.write(out_.view());
  crc_ = crc32_of(out_.view(), crc_);
  written_ += out_.size();
  out_.clear();
}

}  // namespace teleop
