#include "core/recording/mcap_format.hpp"

#include <zlib.h>

namespace teleop {

std::uint32_t crc32_of(ByteView bytes, std::uint32_t before) noexcept {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace teleop
