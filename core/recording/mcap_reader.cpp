#include "core/recording/mcap_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zstd.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{16} << 20U;
constexpr std::size_t kFooterBytes = 20;
constexpr std::size_t kRecordHeadBytes = 9;

class Scanner {
 public:
  Scanner(ByteView file, const std::string& schema_name, const McapVisitor& visit)
      : file_{file}, schema_name_{schema_name}, visit_{visit} {}

  McapScan run() {
    McapCursor cursor{file_};
    static_cast<void>(cursor.raw(kMcapMagic.size()));
    while (!footer_seen_) {
      at_ = cursor.position();
      const auto opcode = static_cast<Opcode>(cursor.number<std::uint8_t>());
      const ByteView content = cursor.sized<std::uint64_t>();
      if (cursor.failed()) {
        scan_.unread_bytes = file_.size() - at_;
        damaged(fmt::format("cut off at byte {} of {}", at_, file_.size()));
        return std::move(scan_);
      }
      if (data_ended_) {
        if (opcode == Opcode::footer) footer(content, cursor.rest());
      } else {
        data_record(opcode, content);
      }
    }
    return std::move(scan_);
  }

 private:
  void damaged(std::string what) {
    if (++scan_.damages <= McapScan::kMostDamage) scan_.damage.push_back(std::move(what));
  }

  void data_record(Opcode opcode, ByteView content) {
    switch (opcode) {
      case Opcode::chunk:
        chunk(content);
        break;
      case Opcode::metadata:
        metadata(content);
        break;
      case Opcode::data_end:
        data_end(content);
        break;
      case Opcode::footer:
        damaged("the data section has no end");
        footer_seen_ = true;
        break;
      default:
        message_or_channel(opcode, content);
    }
  }

  void message_or_channel(Opcode opcode, ByteView content) {
    switch (opcode) {
      case Opcode::schema:
        schema(content);
        break;
      case Opcode::channel:
        channel(content);
        break;
      case Opcode::message:
        message(content);
        break;
      default:
        break;  // indices, and records of a later version
    }
  }

  void schema(ByteView content) {
    McapCursor cursor{content};
    const auto id = cursor.number<std::uint16_t>();
    const std::string name = cursor.text();
    const std::string encoding = cursor.text();
    const std::string definition = cursor.text();
    if (cursor.failed()) return damaged(fmt::format("schema at byte {} is torn", at_));
    if (name == schema_name_ && encoding == "protobuf") schemas_[id] = definition;
  }

  void channel(ByteView content) {
    McapCursor cursor{content};
    const auto id = cursor.number<std::uint16_t>();
    const auto schema = schemas_.find(cursor.number<std::uint16_t>());
    const std::string topic = cursor.text();
    if (cursor.failed()) return damaged(fmt::format("channel at byte {} is torn", at_));
    if (schema == schemas_.end() || channel_) return;
    channel_ = id;
    scan_.channel = {.topic = topic, .schema_name = schema_name_, .schema = schema->second};
  }

  void message(ByteView content) {
    McapCursor cursor{content};
    const auto channel = cursor.number<std::uint16_t>();
    McapMessage message{.sequence = cursor.number<std::uint32_t>(),
                        .log_time_ns = cursor.number<std::uint64_t>()};
    static_cast<void>(cursor.number<std::uint64_t>());  // published when logged
    message.data = cursor.rest();
    if (cursor.failed()) return damaged(fmt::format("message at byte {} is torn", at_));
    if (!channel_ || channel != *channel_) return;
    ++scan_.messages;
    visit_(message);
  }

  void metadata(ByteView content) {
    McapCursor cursor{content};
    static_cast<void>(cursor.text());  // its name
    McapCursor entries{cursor.sized<std::uint32_t>()};
    while (!entries.at_end() && !entries.failed()) {
      std::string key = entries.text();
      std::string value = entries.text();
      if (!entries.failed()) scan_.metadata[std::move(key)] = std::move(value);
    }
    if (cursor.failed() || entries.failed()) {
      damaged(fmt::format("metadata at byte {} are torn", at_));
    }
  }

  void chunk(ByteView content) {
    McapCursor cursor{content};
    static_cast<void>(cursor.raw(2 * sizeof(std::uint64_t)));  // first and last time
    const auto size = cursor.number<std::uint64_t>();
    const auto crc = cursor.number<std::uint32_t>();
    const std::string compression = cursor.text();
    const ByteView compressed = cursor.sized<std::uint64_t>();
    const char* wrong = cursor.failed() ? "torn" : unpack(compressed, compression, size);
    if (wrong == nullptr && crc != 0 && crc != crc32_of(unpacked_)) wrong = "of a wrong CRC";
    if (wrong != nullptr) {
      return damaged(fmt::format("chunk at byte {} is {} and left out", at_, wrong));
    }
    McapCursor records{unpacked_};
    while (!records.at_end()) {
      const auto opcode = static_cast<Opcode>(records.number<std::uint8_t>());
      const ByteView record = records.sized<std::uint64_t>();
      if (records.failed()) return damaged(fmt::format("chunk at byte {} ends in a record", at_));
      message_or_channel(opcode, record);
    }
  }

  /// @returns what is wrong, or nullptr with the chunk in unpacked_.
  const char* unpack(ByteView packed, const std::string& compression, std::uint64_t size) {
    if (size > kMaxChunkBytes) return "larger than 16 MiB";
    unpacked_.assign(packed.begin(), packed.end());
    if (compression.empty()) return size == packed.size() ? nullptr : "of a wrong size";
    if (compression != "zstd") return "compressed in an unknown way";
    unpacked_.resize(static_cast<std::size_t>(size));
    const std::size_t got = ZSTD_decompressDCtx(zstd_.get(), unpacked_.data(), unpacked_.size(),
                                                packed.data(), packed.size());
    return ZSTD_isError(got) == 0 && got == size ? nullptr : "not to be decompressed";
  }

  void data_end(ByteView content) {
    data_ended_ = true;
    summary_at_ = at_ + kRecordHeadBytes + content.size();
    McapCursor cursor{content};
    const auto crc = cursor.number<std::uint32_t>();
    if (cursor.failed()) return damaged("the end of the data section is torn");
    if (crc != 0 && crc != crc32_of(file_.first(at_))) {
      damaged("the CRC of the data section is wrong");
    }
  }

  void footer(ByteView content, ByteView behind) {
    footer_seen_ = true;
    McapCursor cursor{content};
    const auto summary = cursor.number<std::uint64_t>();
    static_cast<void>(cursor.number<std::uint64_t>());  // where the summary offsets begin
    const auto crc = cursor.number<std::uint32_t>();
    if (content.size() != kFooterBytes || !std::ranges::equal(behind, kMcapMagic)) {
      return damaged("the footer is torn");
    }
    const std::size_t end = at_ + kRecordHeadBytes + kFooterBytes - sizeof(crc);
    if (crc != 0 && crc != crc32_of(file_.first(end).subspan(summary_at_))) {
      damaged("the CRC of the summary is wrong");
    } else if (summary != 0 && summary != summary_at_) {
      damaged("the footer points beside the summary");
    }
  }

  struct FreeContext {
    void operator()(ZSTD_DCtx* context) const noexcept { ZSTD_freeDCtx(context); }
  };

  ByteView file_;
  const std::string& schema_name_;
  const McapVisitor& visit_;
  std::unique_ptr<ZSTD_DCtx, FreeContext> zstd_{ZSTD_createDCtx()};
  McapScan scan_;
  std::map<std::uint16_t, std::string> schemas_;  ///< those of the wanted name
  std::optional<std::uint16_t> channel_;
  Bytes unpacked_;
  std::size_t at_ = 0;  ///< where the record began that is being read
  std::size_t summary_at_ = 0;
  bool data_ended_ = false;
  bool footer_seen_ = false;
};

}  // namespace

std::string McapScan::damage_text() const {
  std::string text = fmt::format("{}", fmt::join(damage, "; "));
  if (damages > damage.size()) text += fmt::format("; and {} more", damages - damage.size());
  return text;
}

McapScan scan_mcap(ByteView file, const std::string& schema_name, const McapVisitor& visit) {
  return Scanner{file, schema_name, visit}.run();
}

bool is_mcap(ByteView file) noexcept {
  return file.size() >= kMcapMagic.size() &&
         std::ranges::equal(file.first(kMcapMagic.size()), kMcapMagic);
}

Bytes read_mcap_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  std::ifstream stream{file, std::ios::binary};
  if (error || !stream) {
    const int reason = error ? error.value() : errno;
    throw RecordingError{fmt::format("{}: cannot be read: {}", file.string(),
                                     std::generic_category().message(reason))};
  }
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  if (!is_mcap(bytes)) {
    throw RecordingError{fmt::format("{}: not a recording: it is no MCAP file", file.string())};
  }
  return bytes;
}

}  // namespace teleop
