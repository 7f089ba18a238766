#include "transport/session.hpp"

#include <cstdlib>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::uint64_t kOwn = 0xA;
constexpr std::uint64_t kPeer = 0xB;

Instant at(Duration time) { return Instant{time}; }

Datagram packet(std::uint64_t sequence, std::uint64_t session = kPeer, Duration sent = {}) {
  return {.session = session,
          .sequence = sequence,
          .sent = at(sent),
          .echo = {},
          .state = {.tick = sequence}};
}

/// The sequence numbers delivered when these arrive, a millisecond apart.
std::vector<std::uint64_t> deliver(Receiver& receiver, const std::vector<std::uint64_t>& arrivals) {
  std::vector<std::uint64_t> delivered;
  Duration now{0};
  for (const std::uint64_t sequence : arrivals) {
    now += milliseconds{1};
    if (const auto sample = receiver.step(packet(sequence), at(now))) {
      delivered.push_back(sample->state.tick);
    }
  }
  return delivered;
}

TEST(Session, DeliversOnlyWhatIsNewest) {
  Receiver receiver{kOwn};

  const auto delivered = deliver(receiver, {7, 8, 8, 11, 9, 10, 10, 12});

  EXPECT_EQ(delivered, (std::vector<std::uint64_t>{7, 8, 11, 12}));
  EXPECT_EQ(receiver.statistics().received, 8U);
  EXPECT_EQ(receiver.statistics().duplicated, 2U);
  EXPECT_EQ(receiver.statistics().reordered, 2U);
  EXPECT_EQ(receiver.statistics().lost, 0U);
}

TEST(Session, CountsGapsThatNeverFill) {
  Receiver receiver{kOwn};

  deliver(receiver, {5, 9, 7, 200, 201, 100});

  // 6, 8 and 10…199 are missing; 100 comes too late to be taken back.
  EXPECT_EQ(receiver.statistics().lost, 2U + 190U);
  EXPECT_EQ(receiver.statistics().reordered, 2U);
}

TEST(Session, DoesNotCountAsLostWhatWasSentBeforeItListened) {
  Receiver receiver{kOwn};

  deliver(receiver, {1000, 998, 999, 1001});

  EXPECT_EQ(receiver.statistics().lost, 0U);
  EXPECT_EQ(receiver.statistics().reordered, 2U);
}

/// Packets 1 to 500 through a network that drops, repeats and delays, as a list of arrivals, and
/// what must be counted. No packet is overtaken by 64 later ones.
struct Shuffle {
  explicit Shuffle(std::uint64_t seed) {
    Random random{seed};
    std::multimap<double, std::uint64_t> by_arrival{{0.0, 1}};
    for (std::uint64_t sequence = 2; sequence <= 500; ++sequence) {
      if (random.uniform() < 0.1 && sequence < 500) {
        ++dropped;
        continue;
      }
      const int copies = random.uniform() < 0.1 ? 2 : 1;
      repeated += copies == 2 ? 1U : 0U;
      for (int copy = 0; copy < copies; ++copy) {
        by_arrival.emplace(double(sequence) + random.uniform(0.0, 30.0), sequence);
      }
    }
    std::set<std::uint64_t> seen;
    for (const auto& [time, sequence] : by_arrival) {
      const bool is_new = seen.insert(sequence).second;
      if (is_new && *seen.rbegin() != sequence) ++late;
      arrivals.push_back(sequence);
    }
  }

  std::vector<std::uint64_t> arrivals;
  std::uint64_t dropped = 0;
  std::uint64_t repeated = 0;
  std::uint64_t late = 0;
};

TEST(Session, CountsAnyShuffleExactly) {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe): one thread
  const std::size_t cases = text == nullptr ? 200 : std::strtoull(text, nullptr, 10);
  for (std::size_t seed = 0; seed < cases; ++seed) {
    const Shuffle shuffle{seed};
    Receiver receiver{kOwn};

    deliver(receiver, shuffle.arrivals);

    EXPECT_EQ(receiver.statistics().lost, shuffle.dropped) << "seed " << seed;
    EXPECT_EQ(receiver.statistics().duplicated, shuffle.repeated) << "seed " << seed;
    EXPECT_EQ(receiver.statistics().reordered, shuffle.late) << "seed " << seed;
  }
}

TEST(Session, TakesARestartedPeerOnceTheOldOneIsSilent) {
  Receiver receiver{kOwn};
  ASSERT_TRUE(receiver.step(packet(900), at(milliseconds{100})));

  EXPECT_FALSE(receiver.step(packet(1, 0xC), at(milliseconds{149})));
  EXPECT_EQ(receiver.statistics().refused, 1U);

  const auto sample = receiver.step(packet(2, 0xC), at(milliseconds{150}));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->session, 0xCU);
  EXPECT_EQ(receiver.statistics().lost, 0U);
}

TEST(Session, NeverTakesBackTheOldSession) {
  Receiver receiver{kOwn};
  ASSERT_TRUE(receiver.step(packet(900), at(milliseconds{0})));
  ASSERT_TRUE(receiver.step(packet(1, 0xC), at(milliseconds{60})));

  EXPECT_FALSE(receiver.step(packet(901), at(milliseconds{500})));
  EXPECT_TRUE(receiver.step(packet(2, 0xC), at(milliseconds{501})));
}

TEST(Session, IsNotKeptAliveByOldPacketsThatTheNetworkRepeats) {
  Receiver receiver{kOwn};
  ASSERT_TRUE(receiver.step(packet(900), at(milliseconds{0})));
  EXPECT_FALSE(receiver.step(packet(900), at(milliseconds{45})));

  EXPECT_TRUE(receiver.step(packet(1, 0xC), at(milliseconds{60})));
}

TEST(Session, RefusesItsOwnPacketsReflected) {
  Receiver receiver{kOwn};

  EXPECT_FALSE(receiver.step(packet(1, kOwn), at(milliseconds{1})));

  EXPECT_EQ(receiver.statistics().refused, 1U);
  EXPECT_EQ(receiver.statistics().received, 0U);
}

TEST(Session, MeasuresTheNetworkAndNotTheTick) {
  Sender here{kOwn};
  Sender there{kPeer};
  Receiver receiver_here{kOwn};
  Receiver receiver_there{kPeer};
  const Duration offset = milliseconds{12'345};  // of the peer's clock

  const Datagram question = here.step({}, receiver_here.heard(), at(milliseconds{1}));
  const auto heard = receiver_there.step(question, at(milliseconds{1} + microseconds{40} + offset));
  ASSERT_TRUE(heard);
  EXPECT_FALSE(heard->has_round_trip);
  EXPECT_EQ(heard->one_way_bound, kUnknownDelay);
  const Datagram answer = there.step({}, receiver_there.heard(), at(milliseconds{2} + offset));
  const auto sample = receiver_here.step(answer, at(milliseconds{2} + microseconds{60}));

  ASSERT_TRUE(sample);
  ASSERT_TRUE(sample->has_round_trip);
  EXPECT_EQ(sample->round_trip, microseconds{100});
  EXPECT_GE(sample->one_way_bound, microseconds{60});
  EXPECT_LT(sample->one_way_bound, microseconds{105});
  EXPECT_NEAR(double(sample->one_way.count()), 50e3, 2.0) << "half of it, the split is not seen";
  EXPECT_GE(sample->age_bound(at(milliseconds{3})), milliseconds{1});
}

TEST(Session, TakesNoRoundTripFromALie) {
  for (const Echo& lie : {Echo{.sent = at(milliseconds{11})},
                          Echo{.sent = at(milliseconds{1}), .hold = milliseconds{20}}}) {
    Receiver receiver{kOwn};
    Datagram datagram = packet(1);
    datagram.echo = lie;

    const auto sample = receiver.step(datagram, at(milliseconds{10}));

    ASSERT_TRUE(sample);
    EXPECT_FALSE(sample->has_round_trip);
    EXPECT_EQ(sample->one_way_bound, kUnknownDelay);
  }
}

TEST(Session, RemembersTheVersionThatItRefused) {
  Receiver receiver{kOwn};

  receiver.refuse({.check = Check::version, .version = 9});
  receiver.refuse({.check = Check::torn});

  EXPECT_EQ(receiver.statistics().refused, 2U);
  EXPECT_EQ(receiver.statistics().peer_version, 9U);
}

TEST(Session, StepsWithoutAllocating) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  Sender sender{kPeer};
  Receiver receiver{kOwn};
  const testing::NoAllocation guard;
  const auto sample = receiver.step(sender.step({}, {}, at({})), at(milliseconds{1}));
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_TRUE(sample);
}

}  // namespace
}  // namespace teleop
