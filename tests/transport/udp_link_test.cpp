#include "transport/udp_link.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/transport/raw_peer.hpp"
#include "tests/transport/reseal.hpp"

namespace teleop {
namespace {

using std::chrono::milliseconds;
using testing::RawPeer;

constexpr std::uint64_t kPeer = 0xB;

std::string at_port(const std::string& host, std::uint16_t port) {
  return host + ':' + std::to_string(port);
}

/// Without a thread of its own: what arrives, and when it is looked at, is the test's to say.
UdpLink::Config manual(const std::string& peer = {}) {
  return {.bind = "127.0.0.1:0", .peer = peer, .own_thread = false};
}

UdpLink::Config threaded(const std::string& peer = {}) {
  return {.bind = "127.0.0.1:0", .peer = peer, .realtime = {.enabled = false}};
}

Datagram packet(std::uint64_t sequence, std::uint64_t session = kPeer) {
  return {.session = session,
          .sequence = sequence,
          .sent = std::chrono::steady_clock::now(),
          .state = {.tick = sequence}};
}

/// Waits for a sample that the link's own thread takes in.
std::optional<PeerSample> await(UdpLink& link) {
  const Instant end = std::chrono::steady_clock::now() + std::chrono::seconds{2};
  while (std::chrono::steady_clock::now() < end) {
    if (auto sample = link.receive()) return sample;
    std::this_thread::yield();
  }
  return std::nullopt;
}

class BothFamilies : public ::testing::TestWithParam<std::string> {};

TEST_P(BothFamilies, CarryAStateThereAndBack) {
  if (GetParam() == "[::1]" && !RawPeer{AF_INET6}.is_bound()) GTEST_SKIP() << "no IPv6 here";
  UdpLink slave{{.bind = GetParam() + ":0", .own_thread = false}};
  UdpLink master{
      {.bind = GetParam() + ":0", .peer = at_port(GetParam(), slave.port()), .own_thread = false}};

  master.send({.tick = 1, .p_BT = {0.1, 0.2, 0.3}});
  ASSERT_TRUE(slave.wait());
  const auto there = slave.receive();
  ASSERT_TRUE(there);
  EXPECT_EQ(there->state.p_BT, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(there->session, master.session());
  EXPECT_FALSE(there->has_round_trip);

  slave.send({.tick = 2, .mode = Mode::engaged, .clutch = true});
  ASSERT_TRUE(master.wait());
  const auto back = master.receive();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->state.mode, Mode::engaged);
  EXPECT_TRUE(back->state.clutch);
  ASSERT_TRUE(back->has_round_trip);
  EXPECT_GT(back->round_trip, Duration{0});
  EXPECT_LE(back->one_way, back->one_way_bound);
  EXPECT_LT(back->one_way_bound, std::chrono::seconds{1});
  EXPECT_FALSE(master.receive()) << "a sample is returned once";
}

INSTANTIATE_TEST_SUITE_P(UdpLink, BothFamilies, ::testing::Values("127.0.0.1", "[::1]"));

TEST(UdpLink, SpeaksToNobodyUntilItIsSpokenTo) {
  UdpLink link{manual()};
  link.send({});
  EXPECT_EQ(link.statistics().sent, 0U);

  const RawPeer peer;
  peer.send(link.port(), packet(1));
  ASSERT_TRUE(link.wait());
  link.send({.tick = 5});

  const auto answer = peer.receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->state.tick, 5U);
  ASSERT_TRUE(answer->echo);
  EXPECT_EQ(link.statistics().sent, 1U);
}

TEST(UdpLink, KeepsTheNewestOfPacketsDroppedRepeatedAndSwapped) {
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};
  std::vector<std::uint64_t> delivered;
  for (const std::uint64_t sequence : {1U, 2U, 2U, 5U, 4U, 6U, 5U, 9U}) {
    peer.send(link.port(), packet(sequence));
    ASSERT_TRUE(link.wait());
    if (const auto sample = link.receive()) delivered.push_back(sample->sequence);
  }

  EXPECT_EQ(delivered, (std::vector<std::uint64_t>{1, 2, 5, 6, 9}));
  const LinkStatistics counted = link.statistics();
  EXPECT_EQ(counted.received, 8U);
  EXPECT_EQ(counted.duplicated, 2U);
  EXPECT_EQ(counted.reordered, 1U);
  EXPECT_EQ(counted.lost, 3U) << "3, 7 and 8";
}

TEST(UdpLink, ReturnsOnlyTheNewestOfPacketsThatCameTogether) {
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};
  for (const std::uint64_t sequence : {1U, 2U, 4U, 3U}) {
    peer.send(link.port(), packet(sequence));
  }
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(link.wait());
  }

  const auto sample = link.receive();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->sequence, 4U);
  EXPECT_FALSE(link.receive());
}

TEST(UdpLink, RefusesTornForeignAndOtherVersions) {
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};
  const Packet whole = encode(packet(1));
  Packet torn = whole;
  torn.at(100) ^= std::byte{1};
  Packet newer = whole;
  newer.at(4) = std::byte{9};
  testing::reseal(newer);
  const std::vector<std::byte> jumbo(60'000, std::byte{'t'});

  peer.send(link.port(), std::span<const std::byte>{});
  peer.send(link.port(), std::span{whole}.first(50));
  peer.send(link.port(), torn);
  peer.send(link.port(), newer);
  peer.send(link.port(), jumbo);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(link.wait());
  }

  EXPECT_FALSE(link.receive());
  EXPECT_EQ(link.statistics().refused, 5U);
  EXPECT_EQ(link.statistics().peer_version, 9U);
  EXPECT_EQ(link.statistics().received, 0U);
  peer.send(link.port(), whole);
  ASSERT_TRUE(link.wait());
  EXPECT_TRUE(link.receive());
}

TEST(UdpLink, HearsOnlyThePeerThatItWasGiven) {
  const RawPeer peer;
  const RawPeer stranger;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};

  stranger.send(link.port(), packet(1, 0xC));
  ASSERT_TRUE(link.wait());

  EXPECT_FALSE(link.receive());
  EXPECT_EQ(link.statistics().refused, 1U);
}

TEST(UdpLink, IsNotTakenOverWhileItsPeerSpeaks) {
  const RawPeer peer;
  const RawPeer stranger;
  UdpLink link{manual()};
  peer.send(link.port(), packet(1));
  stranger.send(link.port(), packet(7, 0xC));
  stranger.send(link.port(), packet(2, kPeer));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(link.wait());
  }

  const auto sample = link.receive();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->sequence, 1U);
  EXPECT_EQ(link.statistics().refused, 2U);
}

TEST(UdpLink, AnswersARestartedPeerAtItsNewAddress) {
  const RawPeer killed;
  const RawPeer restarted;
  UdpLink link{manual()};
  killed.send(link.port(), packet(1000));
  ASSERT_TRUE(link.wait());
  ASSERT_TRUE(link.receive());

  // This silence lets another session in; the kernel may cut a wait short by one of its ticks.
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(link.wait());
  }
  restarted.send(link.port(), packet(1, 0xC));
  ASSERT_TRUE(link.wait());

  const auto sample = link.receive();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->session, 0xCU);
  link.send({.tick = 3});
  EXPECT_TRUE(restarted.receive());
  EXPECT_EQ(link.statistics().lost, 0U);
}

TEST(UdpLink, RefusesItsOwnPacketsReflected) {
  const RawPeer mirror;
  UdpLink link{manual(at_port("127.0.0.1", mirror.port()))};
  link.send({});
  const auto own = mirror.receive();
  ASSERT_TRUE(own);

  mirror.send(link.port(), *own);
  ASSERT_TRUE(link.wait());

  EXPECT_FALSE(link.receive());
  EXPECT_EQ(link.statistics().refused, 1U);
}

TEST(UdpLink, TellsTheNetworkFromTheHoldOfThePeer) {
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};
  const auto round_trip_for = [&](std::uint64_t sequence, bool tells_its_hold) {
    link.send({});
    const auto asked = peer.receive();
    const Instant heard = std::chrono::steady_clock::now();
    RawPeer::dawdle(milliseconds{20});
    Datagram answer = packet(sequence);
    answer.echo = Echo{.sent = asked.value().sent};
    if (tells_its_hold) answer.echo->hold = answer.sent - heard;
    peer.send(link.port(), answer);
    EXPECT_TRUE(link.wait());
    return link.receive().value().round_trip;
  };

  EXPECT_LT(round_trip_for(1, true), milliseconds{20});
  EXPECT_GE(round_trip_for(2, false), milliseconds{20});
}

TEST(UdpLink, DoesNotBelieveAnEchoFromTheFuture) {
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};
  Datagram lie = packet(1);
  lie.echo = Echo{.sent = lie.sent + std::chrono::hours{5}, .hold = {}};

  peer.send(link.port(), lie);
  ASSERT_TRUE(link.wait());

  const auto sample = link.receive();
  ASSERT_TRUE(sample);
  EXPECT_FALSE(sample->has_round_trip);
  EXPECT_EQ(sample->one_way_bound, kUnknownDelay);
}

TEST(UdpLink, CountsWhatTheSystemDoesNotTake) {
  // From 127.0.0.1 nothing can be sent to another machine.
  UdpLink link{manual("192.0.2.1:9")};
  link.send({});
  EXPECT_EQ(link.statistics().sent, 0U);
  EXPECT_EQ(link.unsent(), 1U);
}

TEST(UdpLink, NeitherSendsNorTakesInWithAnAllocation) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const RawPeer peer;
  UdpLink link{manual(at_port("127.0.0.1", peer.port()))};

  const testing::NoAllocation guard;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    peer.send(link.port(), packet(i));
    const bool came = link.wait();
    const auto sample = link.receive();
    link.send(sample ? sample->state : PeerState{});
    if (!came || !sample) break;
  }

  EXPECT_EQ(guard.count(), 0U);
  EXPECT_EQ(link.statistics().received, 100U);
}

TEST(UdpLink, ExchangesAThousandStatesThroughItsThread) {
  UdpLink slave{threaded()};
  UdpLink master{threaded(at_port("127.0.0.1", slave.port()))};
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    master.send({.tick = tick});
    const auto there = await(slave);
    ASSERT_TRUE(there);
    ASSERT_EQ(there->state.tick, tick);
    slave.send({.tick = there->state.tick});
    const auto back = await(master);
    ASSERT_TRUE(back);
    ASSERT_EQ(back->state.tick, tick);
    ASSERT_TRUE(back->has_round_trip);
    ASSERT_GE(back->age_bound(std::chrono::steady_clock::now()), Duration{0});
  }
  EXPECT_EQ(master.statistics().received, 1000U);
  EXPECT_EQ(master.statistics().lost, 0U);
  EXPECT_EQ(slave.statistics().sent, 1000U);
}

TEST(UdpLink, IsNotDisturbedByAFloodOfJunk) {
  UdpLink slave{threaded()};
  UdpLink master{threaded(at_port("127.0.0.1", slave.port()))};
  master.send({});
  ASSERT_TRUE(await(slave));
  const RawPeer junk;
  Random random{1};
  std::array<std::byte, 300> bytes{};
  std::uint64_t answered = 0;
  for (std::uint64_t tick = 1; tick <= 300; ++tick) {
    for (int i = 0; i < 30; ++i) {  // fewer than the socket holds
      for (std::byte& byte : bytes) {
        byte = static_cast<std::byte>(random.bits());
      }
      junk.send(slave.port(), std::span{bytes}.first(random.bits() % bytes.size()));
    }
    master.send({.tick = tick});
    const auto sample = await(slave);
    if (sample && sample->state.tick == tick) ++answered;
  }

  EXPECT_EQ(answered, 300U);
  EXPECT_EQ(slave.statistics().lost, 0U);
  EXPECT_EQ(slave.statistics().refused, 9000U);
}

TEST(UdpLink, StopsAtOnceThoughItsThreadIsWaiting) {
  const RawPeer peer;
  Duration fastest = std::chrono::hours{1};
  for (int i = 0; i < 5; ++i) {
    std::optional<UdpLink> link{threaded()};
    peer.send(link->port(), packet(1));
    ASSERT_TRUE(await(*link));
    RawPeer::dawdle(milliseconds{5});
    const Instant start = std::chrono::steady_clock::now();
    link.reset();
    fastest = std::min<Duration>(fastest, std::chrono::steady_clock::now() - start);
  }
  EXPECT_LT(fastest, milliseconds{30}) << "sooner than its timeout";
}

std::string failure_of(const UdpLink::Config& config) {
  try {
    const UdpLink link{config};
  } catch (const TransportError& error) {
    return error.what();
  }
  return "no error";
}

TEST(UdpLink, SaysInOneLineWhatIsWrongWithAnAddress) {
  const UdpLink other{manual()};
  const struct {
    UdpLink::Config config;
    const char* says = "";
  } wrongs[] = {
      {{.bind = at_port("127.0.0.1", other.port())}, "already in use"},
      {{.bind = "192.0.2.1:0"}, "give an address of this machine"},
      {{.bind = "127.0.0.1"}, "no port"},
      {{.peer = "no host:5000"}, "check the name"},
      {{.peer = "[::1]:5000"}, "both must be IPv4 or both IPv6"},
      {{.bind = "[::1]:0", .peer = "127.0.0.1:5000"}, "both must be IPv4 or both IPv6"},
      {{.peer = "127.0.0.1:0"}, "port 0"},
  };
  for (const auto& wrong : wrongs) {
    const std::string failure = failure_of(wrong.config);
    EXPECT_NE(failure.find(wrong.says), std::string::npos) << failure;
    EXPECT_TRUE(failure.starts_with("link.bind = \"") || failure.starts_with("link.peer = \""))
        << failure;
    EXPECT_EQ(failure.find('\n'), std::string::npos) << failure;
  }
}

TEST(UdpLink, TakesItsSettings) {
  UdpLink::Config config;
  Settings settings;
  add_settings(settings, "link.", config);
  settings.load_text("[link]\nbind = \"[::1]:0\"\nreceive.priority = 42\n", "pair.toml");
  EXPECT_EQ(config.bind, "[::1]:0");
  EXPECT_EQ(config.realtime.priority, 42);
}

}  // namespace
}  // namespace teleop
