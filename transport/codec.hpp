#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/time.hpp"
#include "core/ports/peer.hpp"

namespace teleop {

/// The peer's newest packet, handed back to it so that it can measure the round trip.
struct Echo {
  Instant sent{};   ///< when the peer sent it, peer's clock
  Duration hold{};  ///< from its arrival here to the sending of the packet that carries the echo
};

/// What one packet says.
struct Datagram {
  std::uint64_t session = 0;   ///< of the sender, not 0: drawn anew whenever a link is opened
  std::uint64_t sequence = 0;  ///< 1, 2, 3 … within the session
  Instant sent{};              ///< sender's clock
  std::optional<Echo> echo{};  ///< absent until the sender has heard the receiver
  PeerState state{};
};

/// Of the payload: raised whenever a field changes its meaning. The frame never changes.
inline constexpr std::uint16_t kProtocolVersion = 1;

inline constexpr std::size_t kHeaderSize = 8;
inline constexpr std::size_t kPayloadSize = 189;
inline constexpr std::size_t kChecksumSize = 4;
inline constexpr std::size_t kPacketSize = kHeaderSize + kPayloadSize + kChecksumSize;

using Packet = std::array<std::byte, kPacketSize>;

/// Whether bytes are a packet for this program; the first reason that applies.
enum class Check : std::uint8_t {
  ok,
  foreign,       ///< does not begin like a packet of this protocol
  torn,          ///< cut, lengthened or changed on the way
  version,       ///< whole, of another protocol version
  incomplete,    ///< a field is missing or not of its type
  not_finite,    ///< a position, velocity or force is NaN or infinite
  out_of_range,  ///< a time, number or mode that no sender can mean
};

struct Decoded {
  Check check = Check::foreign;
  std::uint16_t version = 0;  ///< as the packet says; 0 when it is foreign or torn
  Datagram datagram{};        ///< meaningful when check is ok
};

/// Thread: any. Loop: neither allocates, blocks nor throws.
[[nodiscard]] Packet encode(const Datagram& datagram) noexcept;

/// Safe for any bytes. Thread: any. Loop: does not allocate for packets that encode() made.
[[nodiscard]] Decoded decode(std::span<const std::byte> bytes) noexcept;

}  // namespace teleop
