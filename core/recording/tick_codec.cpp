#include "core/recording/tick_codec.hpp"

#include <algorithm>
#include <bit>
#include <concepts>

namespace teleop {
namespace {

enum class Wire : std::uint8_t { varint = 0, fixed64 = 1, sized = 2, fixed32 = 5 };

constexpr unsigned kWireBits = 3;
constexpr unsigned kPayloadBits = 7;
constexpr unsigned kMaxVarintBytes = 10;
constexpr std::uint8_t kMore = 0x80;
constexpr std::uint8_t kPayload = 0x7f;

constexpr std::uint32_t zigzag(std::int32_t value) noexcept {
  return (static_cast<std::uint32_t>(value) << 1U) ^ static_cast<std::uint32_t>(value >> 31);
}

constexpr std::int32_t unzigzag(std::uint32_t value) noexcept {
  return static_cast<std::int32_t>((value >> 1U) ^ (0U - (value & 1U)));
}

/// Visits the fields of a record and appends each to a message.
class Encoder {
 public:
  explicit Encoder(Bytes& out) noexcept : out_{out} {}

  template <std::integral T>
  void operator()(const Field& field, T value) {
    if (value == 0) return;
    tag(field, Wire::varint);
    varint(static_cast<std::uint64_t>(value));
  }

  void operator()(const Field& field, double value) {
    if (std::bit_cast<std::uint64_t>(value) == 0) return;  // minus zero stays
    tag(field, Wire::fixed64);
    fixed64(value);
  }

  void operator()(const Field& field, const std::array<std::int32_t, kJoints>& values) {
    tag(field, Wire::sized);
    const std::size_t at = out_.size();
    out_.push_back(std::byte{0});  // three numbers of at most five bytes: one byte of length
    for (const std::int32_t value : values) {
      varint(zigzag(value));
    }
    out_[at] = static_cast<std::byte>(out_.size() - at - 1);
  }

  void operator()(const Field& field, const Vector3& values) {
    tag(field, Wire::sized);
    varint(sizeof(double) * static_cast<std::size_t>(values.size()));
    for (const double value : values) {
      fixed64(value);
    }
  }

 private:
  void tag(const Field& field, Wire wire) {
    varint((static_cast<std::uint64_t>(field.number) << kWireBits) |
           static_cast<std::uint64_t>(wire));
  }

  void varint(std::uint64_t value) {
    for (; value > kPayload; value >>= kPayloadBits) {
      out_.push_back(static_cast<std::byte>(value | kMore));
    }
    out_.push_back(static_cast<std::byte>(value));
  }

  void fixed64(double value) {
    const ByteView bytes = std::as_bytes(std::span{&value, 1});
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

  Bytes& out_;
};

std::uint64_t read_varint(McapCursor& cursor) noexcept {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < kMaxVarintBytes; ++i) {
    const auto byte = cursor.number<std::uint8_t>();
    value |= static_cast<std::uint64_t>(byte & kPayload) << (kPayloadBits * i);
    if ((byte & kMore) == 0) return value;
  }
  static_cast<void>(cursor.raw(UINT64_MAX));  // endless: the message is torn
  return 0;
}

/// One field as it stands in a message. Visits the fields of a record and sets the one that has
/// its number and its type.
class Decoder {
 public:
  explicit Decoder(McapCursor& cursor) noexcept {
    const std::uint64_t tag = read_varint(cursor);
    number_ = tag >> kWireBits;
    wire_ = static_cast<Wire>(tag & ((1U << kWireBits) - 1));
    switch (wire_) {
      case Wire::varint:
        value_ = read_varint(cursor);
        break;
      case Wire::fixed64:
        value_ = cursor.number<std::uint64_t>();
        break;
      case Wire::fixed32:
        value_ = cursor.number<std::uint32_t>();
        break;
      case Wire::sized:
        content_ = cursor.raw(read_varint(cursor));
        break;
      default:
        static_cast<void>(cursor.raw(UINT64_MAX));  // groups and nonsense
    }
  }

  template <std::integral T>
  void operator()(const Field& field, T& value) const noexcept {
    if (is(field, Wire::varint)) value = static_cast<T>(value_);
  }

  void operator()(const Field& field, double& value) const noexcept {
    if (is(field, Wire::fixed64)) value = std::bit_cast<double>(value_);
  }

  void operator()(const Field& field, std::array<std::int32_t, kJoints>& values) const noexcept {
    if (!is(field, Wire::sized)) return;
    McapCursor cursor{content_};
    for (std::int32_t& value : values) {
      value = unzigzag(static_cast<std::uint32_t>(read_varint(cursor)));
    }
  }

  void operator()(const Field& field, Vector3& values) const noexcept {
    if (!is(field, Wire::sized)) return;
    McapCursor cursor{content_};
    for (double& value : values) {
      value = std::bit_cast<double>(cursor.number<std::uint64_t>());
    }
  }

 private:
  [[nodiscard]] bool is(const Field& field, Wire wire) const noexcept {
    return number_ == static_cast<std::uint64_t>(field.number) && wire_ == wire;
  }

  std::uint64_t number_ = 0;
  Wire wire_ = Wire::varint;
  std::uint64_t value_ = 0;
  ByteView content_{};
};

}  // namespace

void encode_tick(const TickRecord& record, Bytes& out) { for_each_field(record, Encoder{out}); }

std::optional<TickRecord> decode_tick(ByteView message) noexcept {
  TickRecord record;
  McapCursor cursor{message};
  while (!cursor.at_end()) {
    const Decoder field{cursor};
    if (cursor.failed()) return std::nullopt;
    for_each_field(record, field);
  }
  return record;
}

}  // namespace teleop
