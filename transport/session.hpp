#pragma once

#include <cstdint>
#include <optional>

#include "core/base/time.hpp"
#include "core/ports/link.hpp"
#include "core/ports/peer.hpp"
#include "transport/clock_sync.hpp"
#include "transport/codec.hpp"
#include "transport/sequence_window.hpp"

namespace teleop {

/// A session that has delivered nothing for so long may be replaced by another one.
inline constexpr Duration kSessionSilence = std::chrono::milliseconds{50};

/// The newest packet of the peer, kept to be echoed.
struct Heard {
  Instant sent{};      ///< peer's clock
  Instant received{};  ///< own clock
};

/// The sending half of a link without its socket: numbers the packets and echoes the peer.
/// Thread: one. Loop: neither allocates, blocks nor throws.
class Sender {
 public:
  explicit Sender(std::uint64_t session) noexcept : session_{session} {}

  [[nodiscard]] Datagram step(const PeerState& state,
                              const std::optional<Heard>& heard,
                              Instant now) noexcept;

 private:
  std::uint64_t session_;
  std::uint64_t sequence_ = 0;
};

/// The receiving half of a link without its socket: one peer's session, its sequence, its clock and
/// the counters of LinkStatistics but `sent`.
///
/// The first session heard is taken. Another one replaces it when it has delivered nothing for
/// kSessionSilence (the peer was restarted); the one replaced never comes back, nor does the own
/// one (a reflected packet). Everything else is refused.
///
/// Thread: one. Loop: neither allocates, blocks nor throws.
class Receiver {
 public:
  explicit Receiver(std::uint64_t own_session) noexcept : own_{own_session} {}

  /// The state that arrived; nothing when it is refused, repeated or late.
  [[nodiscard]] std::optional<PeerSample> step(const Datagram& datagram, Instant arrival) noexcept;

  /// Counts a packet that does not reach step().
  void refuse(const Decoded& decoded) noexcept;

  /// Whether a packet of this session, arriving now, would start a new one.
  [[nodiscard]] bool would_adopt(std::uint64_t session, Instant now) const noexcept;

  [[nodiscard]] const std::optional<Heard>& heard() const noexcept { return heard_; }
  [[nodiscard]] const LinkStatistics& statistics() const noexcept { return statistics_; }

 private:
  void adopt(std::uint64_t session) noexcept;
  [[nodiscard]] std::optional<Duration> measure(const Datagram& datagram, Instant arrival) noexcept;

  std::uint64_t own_;
  std::uint64_t session_ = 0;  // 0: none yet
  std::uint64_t retired_ = 0;
  SequenceWindow window_;
  ClockSync clock_;
  std::optional<Heard> heard_;
  LinkStatistics statistics_;
};

}  // namespace teleop
