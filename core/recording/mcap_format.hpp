#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace teleop {

/// The byte level of MCAP, version 0 [MCAP]: a file is
///     magic, header, data section, data end, summary section, summary offsets, footer, magic;
/// every record is an opcode (1 byte), the length of its content (8 bytes) and the content. Numbers
/// are little-endian; strings, arrays and maps carry their length in bytes (4 bytes) before them.

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

inline constexpr std::array<std::byte, 8> kMcapMagic{
    std::byte{0x89}, std::byte{'M'}, std::byte{'C'},  std::byte{'A'},
    std::byte{'P'},  std::byte{'0'}, std::byte{'\r'}, std::byte{'\n'}};

enum class Opcode : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  metadata = 12,
  metadata_index = 13,
  summary_offset = 14,
  data_end = 15,
};

static_assert(std::endian::native == std::endian::little, "numbers are copied as they stand");

/// CRC-32 of zlib and MCAP, continued from the CRC of what stands before.
[[nodiscard]] std::uint32_t crc32_of(ByteView bytes, std::uint32_t before = 0) noexcept;

[[nodiscard]] inline ByteView bytes_of(std::string_view text) noexcept {
  return std::as_bytes(std::span{text});
}

/// Writes MCAP's types into memory, one after the other.
class McapBuffer {
 public:
  template <std::unsigned_integral T>
  void number(T value) {
    raw(std::as_bytes(std::span{&value, 1}));
  }

  void raw(ByteView bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  void text(std::string_view value) {
    sized<std::uint32_t>([&] { raw(bytes_of(value)); });
  }

  void map(const std::map<std::string, std::string>& entries) {
    sized<std::uint32_t>([&] {
      for (const auto& [key, value] : entries) {
        text(key);
        text(value);
      }
    });
  }

  /// What `content` writes, its length in bytes before it.
  template <std::unsigned_integral Length, class Content>
  void sized(Content&& content) {
    const std::size_t at = bytes_.size();
    number(Length{0});
    content();
    const auto length = static_cast<Length>(bytes_.size() - at - sizeof(Length));
    std::memcpy(bytes_.data() + at, &length, sizeof(Length));
  }

  template <class Content>
  void record(Opcode opcode, Content&& content) {
    number(static_cast<std::uint8_t>(opcode));
    sized<std::uint64_t>(content);
  }

  void clear() noexcept { bytes_.clear(); }
  [[nodiscard]] std::size_t size() const noexcept { return bytes_.size(); }
  [[nodiscard]] ByteView view() const noexcept { return bytes_; }
  [[nodiscard]] Bytes& bytes() noexcept { return bytes_; }

 private:
  Bytes bytes_;
};

/// Reads them back from bytes that nobody vouches for: past the end everything is zero or empty and
/// failed() is true from then on.
class McapCursor {
 public:
  explicit McapCursor(ByteView bytes) noexcept : bytes_{bytes} {}

  template <std::unsigned_integral T>
  [[nodiscard]] T number() noexcept {
    T value{0};
    const ByteView bytes = raw(sizeof(T));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  [[nodiscard]] ByteView raw(std::uint64_t size) noexcept {
    if (failed_ || size > bytes_.size() - position_) {
      failed_ = true;
      return {};
    }
    const ByteView result = bytes_.subspan(position_, static_cast<std::size_t>(size));
    position_ += result.size();
    return result;
  }

  template <std::unsigned_integral Length>
  [[nodiscard]] ByteView sized() noexcept {
    return raw(number<Length>());
  }

  [[nodiscard]] std::string text() {
    const ByteView bytes = sized<std::uint32_t>();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  [[nodiscard]] ByteView rest() noexcept { return raw(bytes_.size() - position_); }
  [[nodiscard]] std::size_t position() const noexcept { return position_; }
  [[nodiscard]] bool at_end() const noexcept { return position_ == bytes_.size(); }
  [[nodiscard]] bool failed() const noexcept { return failed_; }

 private:
  ByteView bytes_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

}  // namespace teleop
