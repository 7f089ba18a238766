#pragma once

#include <cstdint>

#include "core/base/fault.hpp"
#include "core/base/time.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

enum class Role : std::uint8_t { master = 0, slave = 1 };

[[nodiscard]] constexpr const char* name_of(Role role) noexcept {
  return role == Role::master ? "master" : "slave";
}

/// What one side is doing; the transition table is in core/control/supervisor.hpp.
enum class Mode : std::uint8_t { idle = 0, engaging = 1, engaged = 2, holding = 3, faulted = 4 };

[[nodiscard]] constexpr const char* name_of(Mode mode) noexcept {
  switch (mode) {
    case Mode::idle:
      return "idle";
    case Mode::engaging:
      return "engaging";
    case Mode::engaged:
      return "engaged";
    case Mode::holding:
      return "holding";
    case Mode::faulted:
      return "faulted";
  }
  return "unknown";
}

/// What one side tells the other every tick. Positions are absolute, each with its reference, so a
/// lost packet loses nothing. Expressed in the sender's base frame B.
struct PeerState {
  std::uint64_t tick = 0;
  Vector3 p_BT = Vector3::Zero();       ///< tool position, m
  Vector3 v_BT = Vector3::Zero();       ///< tool velocity, m/s
  Vector3 f_T = Vector3::Zero();        ///< coupling force commanded at the tool, N
  Vector3 reference = Vector3::Zero();  ///< x_0: tool position at engaging, m
  std::uint32_t epoch = 0;  ///< counts engagements; references of one epoch belong together
  Mode mode = Mode::idle;
  Fault fault = Fault::none;
  bool clutch = false;  ///< the sender's operator holds the clutch
};

/// A peer state as it arrived.
struct PeerSample {
  PeerState state{};
  std::uint64_t session = 0;  ///< of the sender; another number is a restarted peer
  std::uint64_t sequence = 0;
  Instant received{};     ///< own clock
  Instant sent{};         ///< sender's clock
  Duration round_trip{};  ///< network only: arrival − echoed send − the peer's hold; 0 unknown
  bool has_round_trip = false;
  Duration one_way{};        ///< estimated time on the way: offset seen through the best echo
  Duration one_way_bound{};  ///< upper bound: the same plus half the smallest round trip

  /// Upper bound of the age of the state at `now`; safety uses this one.
  [[nodiscard]] Duration age_bound(Instant now) const noexcept {
    return now - received + one_way_bound;
  }
  [[nodiscard]] Duration age(Instant now) const noexcept { return now - received + one_way; }
};

}  // namespace teleop
