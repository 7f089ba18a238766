#include "transport/codec.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/transport/reseal.hpp"
#include "transport/crc32c.hpp"

namespace teleop {
namespace {

using std::chrono::nanoseconds;
using testing::reseal;

std::size_t cases(std::size_t usual) {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe): one thread
  return text == nullptr ? usual : static_cast<std::size_t>(std::strtoull(text, nullptr, 10));
}

Vector3 random_vector(Random& random) {
  return {random.normal(), random.normal() * 1e-300, random.normal() * 1e300};
}

Datagram random_datagram(Random& random) {
  Datagram datagram{.session = random.bits() | 1U,
                    .sequence = (random.bits() >> 8U) + 1,
                    .sent = Instant{nanoseconds{static_cast<std::int64_t>(random.bits() >> 5U)}},
                    .echo = {},
                    .state = {.tick = random.bits(),
                              .p_BT = random_vector(random),
                              .v_BT = random_vector(random),
                              .f_T = random_vector(random),
                              .reference = random_vector(random),
                              .epoch = static_cast<std::uint32_t>(random.bits() >> 32U),
                              .mode = static_cast<Mode>(random.bits() % 5U),
                              .fault = static_cast<Fault>(random.bits() % 7U),
                              .clutch = random.uniform() < 0.5}};
  if (random.uniform() < 0.8) {
    datagram.echo = Echo{Instant{nanoseconds{static_cast<std::int64_t>(random.bits() >> 5U)}},
                         nanoseconds{static_cast<std::int64_t>(random.bits() >> 30U)}};
  }
  return datagram;
}

void expect_equal(const Datagram& a, const Datagram& b) {
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.sent, b.sent);
  ASSERT_EQ(a.echo.has_value(), b.echo.has_value());
  if (a.echo && b.echo) {
    EXPECT_EQ(a.echo->sent, b.echo->sent);
    EXPECT_EQ(a.echo->hold, b.echo->hold);
  }
  EXPECT_EQ(a.state.tick, b.state.tick);
  EXPECT_EQ(a.state.p_BT, b.state.p_BT);
  EXPECT_EQ(a.state.v_BT, b.state.v_BT);
  EXPECT_EQ(a.state.f_T, b.state.f_T);
  EXPECT_EQ(a.state.reference, b.state.reference);
  EXPECT_EQ(a.state.epoch, b.state.epoch);
  EXPECT_EQ(a.state.mode, b.state.mode);
  EXPECT_EQ(a.state.fault, b.state.fault);
  EXPECT_EQ(a.state.clutch, b.state.clutch);
}

Packet any_packet() {
  Random random{3};
  return encode(random_datagram(random));
}

TEST(Codec, ReturnsEveryDatagramUnchanged) {
  Random random{1};
  for (std::size_t i = 0; i < cases(1000); ++i) {
    const Datagram datagram = random_datagram(random);
    const Decoded decoded = decode(encode(datagram));
    ASSERT_EQ(decoded.check, Check::ok);
    EXPECT_EQ(decoded.version, kProtocolVersion);
    expect_equal(datagram, decoded.datagram);
  }
}

TEST(Codec, SendsZerosInFull) {
  const Decoded decoded = decode(encode({.session = 1, .sequence = 1}));

  ASSERT_EQ(decoded.check, Check::ok);
  expect_equal(decoded.datagram, {.session = 1, .sequence = 1});
}

TEST(Codec, WritesTheFrameThatTheDocumentShows) {
  const Packet packet = any_packet();

  const std::vector<std::byte> start(packet.begin(), packet.begin() + 8);
  const std::vector<std::byte> expected{std::byte{'t'}, std::byte{'l'}, std::byte{'o'},
                                        std::byte{'p'}, std::byte{1},   std::byte{0},
                                        std::byte{189}, std::byte{0}};
  EXPECT_EQ(start, expected);
  EXPECT_EQ(packet.size(), 201U);
}

TEST(Codec, RejectsEveryTruncatedPacket) {
  const Packet packet = any_packet();
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_EQ(decode(std::span{packet}.first(size)).check, Check::torn) << size << " bytes";
  }
}

TEST(Codec, RejectsALengthenedPacket) {
  const Packet packet = any_packet();
  std::vector<std::byte> longer(packet.begin(), packet.end());
  longer.push_back(std::byte{0});
  EXPECT_EQ(decode(longer).check, Check::torn);
}

TEST(Codec, RejectsEverySingleBitFlip) {
  const Packet packet = any_packet();
  for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
    Packet changed = packet;
    changed.at(bit / 8) ^= std::byte{1} << (bit % 8);
    EXPECT_EQ(decode(changed).check, bit < 32 ? Check::foreign : Check::torn) << "bit " << bit;
  }
}

TEST(Codec, RejectsTwoPacketsTornIntoOne) {
  Random random{4};
  const Packet a = encode(random_datagram(random));
  const Packet b = encode(random_datagram(random));
  for (std::size_t cut = kHeaderSize + 1; cut < kPacketSize - kChecksumSize; ++cut) {
    Packet mixed = a;
    std::copy(b.begin() + static_cast<std::ptrdiff_t>(cut), b.end(),
              mixed.begin() + static_cast<std::ptrdiff_t>(cut));
    if (mixed == b) continue;
    EXPECT_EQ(decode(mixed).check, Check::torn) << "cut at " << cut;
  }
}

TEST(Codec, NamesTheVersionThatItRefuses) {
  Packet packet = any_packet();
  packet.at(4) = std::byte{7};
  packet.at(5) = std::byte{1};
  reseal(packet);

  const Decoded decoded = decode(packet);

  EXPECT_EQ(decoded.check, Check::version);
  EXPECT_EQ(decoded.version, 263U);
}

TEST(Codec, RefusesAnotherVersionOfAnotherSize) {
  std::vector<std::byte> bytes{std::byte{'t'}, std::byte{'l'}, std::byte{'o'},
                               std::byte{'p'}, std::byte{2},   std::byte{0},
                               std::byte{1},   std::byte{0},   std::byte{42}};
  const std::uint32_t crc = crc32c(bytes);
  for (std::size_t i = 0; i < kChecksumSize; ++i) {
    bytes.push_back(static_cast<std::byte>((crc >> (8U * i)) & 0xFFU));
  }
  EXPECT_EQ(decode(bytes).check, Check::version);
}

TEST(Codec, RefusesNumbersThatAreNone) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {kNaN, kInfinity, -kInfinity}) {
    for (Vector3 PeerState::* field :
         {&PeerState::p_BT, &PeerState::v_BT, &PeerState::f_T, &PeerState::reference}) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Datagram datagram{.session = 1, .sequence = 1};
        (datagram.state.*field)[axis] = wrong;
        EXPECT_EQ(decode(encode(datagram)).check, Check::not_finite) << wrong << ", " << axis;
      }
    }
  }
}

TEST(Codec, RefusesWhatNoSenderCanMean) {
  const Instant never{nanoseconds{std::numeric_limits<std::int64_t>::max()}};
  const Instant before{nanoseconds{-2}};
  const Datagram good{.session = 1, .sequence = 1};
  const auto check_with = [&](auto change) {
    Datagram datagram = good;
    change(datagram);
    return decode(encode(datagram)).check;
  };
  EXPECT_EQ(check_with([](Datagram&) {}), Check::ok);
  EXPECT_EQ(check_with([](Datagram& d) { d.session = 0; }), Check::out_of_range);
  EXPECT_EQ(check_with([](Datagram& d) { d.sequence = 0; }), Check::out_of_range);
  EXPECT_EQ(check_with([&](Datagram& d) { d.sent = never; }), Check::out_of_range);
  EXPECT_EQ(check_with([&](Datagram& d) { d.sent = before; }), Check::out_of_range);
  EXPECT_EQ(check_with([&](Datagram& d) { d.echo = Echo{.sent = never}; }), Check::out_of_range);
  EXPECT_EQ(check_with([&](Datagram& d) { d.echo = Echo{.sent = before}; }), Check::out_of_range);
  EXPECT_EQ(check_with([](Datagram& d) { d.echo = Echo{.hold = nanoseconds{-1}}; }),
            Check::out_of_range);
  EXPECT_EQ(check_with([](Datagram& d) { d.state.mode = static_cast<Mode>(5); }),
            Check::out_of_range);
  EXPECT_EQ(check_with([](Datagram& d) { d.state.fault = static_cast<Fault>(100); }),
            Check::out_of_range);
}

TEST(Codec, RefusesAWholePacketWithAFieldMissing) {
  Packet packet = any_packet();
  // The tag of field 2 (fixed64) becomes that of field 1: session twice, no sequence.
  ASSERT_EQ(packet.at(kHeaderSize + 9), std::byte{0x11});
  packet.at(kHeaderSize + 9) = std::byte{0x09};
  reseal(packet);

  EXPECT_EQ(decode(packet).check, Check::incomplete);
}

TEST(Codec, SurvivesWhateverIsBehindTheChecksum) {
  Random random{5};
  for (std::size_t i = 0; i < cases(20'000); ++i) {
    Packet packet = encode(random_datagram(random));
    const std::uint64_t changes = 1 + random.bits() % 8;
    for (std::uint64_t n = 0; n < changes; ++n) {
      packet.at(kHeaderSize + random.bits() % kPayloadSize) = static_cast<std::byte>(random.bits());
    }
    reseal(packet);
    const Decoded decoded = decode(packet);
    if (decoded.check != Check::ok) continue;
    EXPECT_TRUE(decoded.datagram.state.p_BT.allFinite());
    EXPECT_LE(static_cast<int>(decoded.datagram.state.mode), 4);
    expect_equal(decode(encode(decoded.datagram)).datagram, decoded.datagram);
  }
}

TEST(Codec, RefusesNoise) {
  Random random{6};
  for (std::size_t i = 0; i < cases(20'000); ++i) {
    std::vector<std::byte> noise(random.bits() % 400);
    for (std::byte& byte : noise) {
      byte = static_cast<std::byte>(random.bits());
    }
    EXPECT_NE(decode(noise).check, Check::ok);
  }
}

TEST(Codec, WorksWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Random random{7};
  const Datagram datagram = random_datagram(random);

  const testing::NoAllocation guard;
  const Decoded decoded = decode(encode(datagram));

  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(decoded.check, Check::ok);
}

}  // namespace
}  // namespace teleop
