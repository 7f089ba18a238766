#include "transport/crc32c.hpp"

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace teleop {
namespace {

TEST(Crc32c, AgreesWithThePublishedVectors) {
  // RFC 3720, appendix B.4, and the check value of the catalogue of CRCs.
  const std::vector<std::byte> zeros(32);
  const std::vector<std::byte> ones(32, std::byte{0xFF});
  constexpr std::string_view kDigits = "123456789";

  EXPECT_EQ(crc32c(zeros), 0x8A9136AAU);
  EXPECT_EQ(crc32c(ones), 0x62A8AB43U);
  EXPECT_EQ(crc32c(std::as_bytes(std::span{kDigits})), 0xE3069283U);
  EXPECT_EQ(crc32c({}), 0U);
}

}  // namespace
}  // namespace teleop
