#include "transport/codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/contract.hpp"
#include "transport/crc32c.hpp"
#include "transport/teleop.pb.h"

namespace teleop {
namespace {

constexpr std::array kMagic{std::byte{'t'}, std::byte{'l'}, std::byte{'o'}, std::byte{'p'}};
constexpr std::size_t kVersionAt = 4;
constexpr std::size_t kLengthAt = 6;
constexpr std::int64_t kNoEcho = -1;
/// 36 years. Sums and differences of a few such times cannot overflow.
constexpr std::int64_t kLatest = std::int64_t{1} << 60U;
constexpr std::uint32_t kLastMode = static_cast<std::uint32_t>(Mode::faulted);
constexpr std::uint32_t kLastFault = 99;

template <class Integer>
void store(std::span<std::byte> out, Integer value) noexcept {
  const std::uint64_t bits = value;
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out[i] = static_cast<std::byte>((bits >> (8U * i)) & 0xFFU);
  }
}

template <class Integer>
Integer load(std::span<const std::byte> in) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    value |= std::to_integer<std::uint64_t>(in[i]) << (8U * i);
  }
  return static_cast<Integer>(value);
}

std::int64_t nanoseconds(Instant instant) noexcept { return instant.time_since_epoch().count(); }
Instant instant(std::int64_t ns) noexcept { return Instant{Duration{ns}}; }

void write_message(const Datagram& datagram, wire::Datagram& out) noexcept {
  const PeerState& state = datagram.state;
  out.set_session(datagram.session);
  out.set_sequence(datagram.sequence);
  out.set_sent_ns(nanoseconds(datagram.sent));
  out.set_echo_sent_ns(datagram.echo ? nanoseconds(datagram.echo->sent) : kNoEcho);
  out.set_echo_hold_ns(datagram.echo ? datagram.echo->hold.count() : 0);
  out.set_tick(state.tick);
  out.set_p_x_m(state.p_BT.x());
  out.set_p_y_m(state.p_BT.y());
  out.set_p_z_m(state.p_BT.z());
  out.set_v_x_m_per_s(state.v_BT.x());
  out.set_v_y_m_per_s(state.v_BT.y());
  out.set_v_z_m_per_s(state.v_BT.z());
  out.set_force_x_n(state.f_T.x());
  out.set_force_y_n(state.f_T.y());
  out.set_force_z_n(state.f_T.z());
  out.set_reference_x_m(state.reference.x());
  out.set_reference_y_m(state.reference.y());
  out.set_reference_z_m(state.reference.z());
  out.set_epoch(state.epoch);
  out.set_mode(static_cast<std::uint32_t>(state.mode));
  out.set_fault(static_cast<std::uint32_t>(state.fault));
  out.set_clutch(state.clutch ? 1U : 0U);
}

bool is_complete(const wire::Datagram& in) noexcept {
  return in.has_session() && in.has_sequence() && in.has_sent_ns() && in.has_echo_sent_ns() &&
         in.has_echo_hold_ns() && in.has_tick() && in.has_p_x_m() && in.has_p_y_m() &&
         in.has_p_z_m() && in.has_v_x_m_per_s() && in.has_v_y_m_per_s() && in.has_v_z_m_per_s() &&
         in.has_force_x_n() && in.has_force_y_n() && in.has_force_z_n() && in.has_reference_x_m() &&
         in.has_reference_y_m() && in.has_reference_z_m() && in.has_epoch() && in.has_mode() &&
         in.has_fault() && in.has_clutch();
}

bool is_time(std::int64_t ns) noexcept { return ns >= 0 && ns <= kLatest; }

bool is_in_range(const wire::Datagram& in) noexcept {
  const bool has_echo = in.echo_sent_ns() != kNoEcho;
  return in.session() != 0 && in.sequence() != 0 && is_time(in.sent_ns()) &&
         (!has_echo || is_time(in.echo_sent_ns())) && is_time(in.echo_hold_ns()) &&
         in.mode() <= kLastMode && in.fault() <= kLastFault && in.clutch() <= 1;
}

Datagram read_message(const wire::Datagram& in) noexcept {
  Datagram out{.session = in.session(),
               .sequence = in.sequence(),
               .sent = instant(in.sent_ns()),
               .echo = {},
               .state = {.tick = in.tick(),
                         .p_BT = {in.p_x_m(), in.p_y_m(), in.p_z_m()},
                         .v_BT = {in.v_x_m_per_s(), in.v_y_m_per_s(), in.v_z_m_per_s()},
                         .f_T = {in.force_x_n(), in.force_y_n(), in.force_z_n()},
                         .reference = {in.reference_x_m(), in.reference_y_m(), in.reference_z_m()},
                         .epoch = in.epoch(),
                         .mode = static_cast<Mode>(in.mode()),
                         .fault = static_cast<Fault>(in.fault()),
                         .clutch = in.clutch() != 0}};
  if (in.echo_sent_ns() != kNoEcho) {
    out.echo = Echo{.sent = instant(in.echo_sent_ns()), .hold = Duration{in.echo_hold_ns()}};
  }
  return out;
}

bool is_finite(const PeerState& state) noexcept {
  return state.p_BT.allFinite() && state.v_BT.allFinite() && state.f_T.allFinite() &&
         state.reference.allFinite();
}

/// The frame is the same in every version, so a whole packet of another one is told from a torn
/// packet of this one.
Check check_frame(std::span<const std::byte> bytes) noexcept {
  const std::size_t start = std::min(bytes.size(), kMagic.size());
  if (!std::equal(kMagic.begin(), kMagic.begin() + static_cast<std::ptrdiff_t>(start),
                  bytes.begin())) {
    return Check::foreign;
  }
  if (bytes.size() < kHeaderSize + kChecksumSize) return Check::torn;
  const std::size_t length = load<std::uint16_t>(bytes.subspan(kLengthAt));
  if (bytes.size() != kHeaderSize + length + kChecksumSize) return Check::torn;
  const std::size_t end = kHeaderSize + length;
  return load<std::uint32_t>(bytes.subspan(end)) == crc32c(bytes.first(end)) ? Check::ok
                                                                             : Check::torn;
}

}  // namespace

Packet encode(const Datagram& datagram) noexcept {
  Packet packet{};
  const std::span<std::byte> bytes{packet};
  std::copy(kMagic.begin(), kMagic.end(), packet.begin());
  store(bytes.subspan(kVersionAt), kProtocolVersion);
  store(bytes.subspan(kLengthAt), static_cast<std::uint16_t>(kPayloadSize));

  wire::Datagram message;
  write_message(datagram, message);
  const bool fits = message.ByteSizeLong() == kPayloadSize &&
                    message.SerializeToArray(&packet[kHeaderSize], kPayloadSize);
  expects(fits, "kPayloadSize is the size of the message in teleop.proto");

  const std::size_t end = kHeaderSize + kPayloadSize;
  store(bytes.subspan(end), crc32c(bytes.first(end)));
  return packet;
}

Decoded decode(std::span<const std::byte> bytes) noexcept {
  Decoded decoded{.check = check_frame(bytes)};
  if (decoded.check != Check::ok) return decoded;
  decoded.version = load<std::uint16_t>(bytes.subspan(kVersionAt));

  const auto refuse = [&](Check reason) {
    decoded.check = reason;
    return decoded;
  };
  if (decoded.version != kProtocolVersion) return refuse(Check::version);
  if (bytes.size() != kPacketSize) return refuse(Check::incomplete);
  wire::Datagram message;
  if (!message.ParseFromArray(&bytes[kHeaderSize], kPayloadSize) || !is_complete(message)) {
    return refuse(Check::incomplete);
  }
  if (!is_in_range(message)) return refuse(Check::out_of_range);
  decoded.datagram = read_message(message);
  if (!is_finite(decoded.datagram.state)) return refuse(Check::not_finite);
  return decoded;
}

}  // namespace teleop
