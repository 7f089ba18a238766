#pragma once

#include "transport/codec.hpp"
#include "transport/crc32c.hpp"

namespace teleop::testing {

/// Makes a changed packet whole again, so that what is behind the checksum is tested.
inline void reseal(Packet& packet) {
  const std::size_t end = kPacketSize - kChecksumSize;
  const std::uint32_t crc = crc32c(std::span{packet}.first(end));
  for (std::size_t i = 0; i < kChecksumSize; ++i) {
    packet.at(end + i) = static_cast<std::byte>((crc >> (8U * i)) & 0xFFU);
  }
}

}  // namespace teleop::testing
