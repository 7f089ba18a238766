#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/fault.hpp"
#include "core/base/settings.hpp"
#include "core/control/position_error.hpp"
#include "core/ports/peer.hpp"

namespace teleop {

/// What can move a supervisor from one mode to another.
enum class Event : std::uint8_t {
  enable = 0,           ///< amplifiers may go on
  disable = 1,          ///< leave the coupling, then amplifiers off
  peer_ready = 2,       ///< fresh peer with the own epoch, nobody holds the clutch, ramp at 0
  ramp_done = 3,        ///< the coupling is fully on
  peer_lost = 4,        ///< silent, of another epoch, clutched or not coupled
  clutch_pressed = 5,   ///< by the own operator
  clutch_released = 6,  ///< by the own operator
  fault = 7,            ///< a fault that stops the arm
  reset = 8,            ///< the operator has seen the fault
};
inline constexpr std::size_t kEvents = 9;
inline constexpr std::size_t kModes = 5;

/// The transition table: kTransitions[mode][event] is the next mode.
///
///     idle      no coupling; amplifiers on once enabled
///     engaging  the peer is there; the coupling waits for it at ramp 0, then rises to 1
///     engaged   coupled
///     holding   the link is silent, a clutch is held or epochs differ: the coupling falls to 0,
///               gravity compensation and damping stay
///     faulted   torques zero, amplifiers off; left by reset alone
inline constexpr std::array<std::array<Mode, kEvents>, kModes> kTransitions = [] {
  using enum Mode;
  return std::array<std::array<Mode, kEvents>, kModes>{{
      // clang-format off
      // enable   disable  peer_ready ramp_done peer_lost clutch_pr. clutch_rel. fault    reset
      {idle,      idle,    engaging,  idle,     idle,     idle,      idle,       faulted, idle},
      {engaging,  idle,    engaging,  engaged,  holding,  holding,   engaging,   faulted, engaging},
      {engaged,   idle,    engaged,   engaged,  holding,  holding,   engaged,    faulted, engaged},
      {holding,   idle,    engaging,  holding,  holding,  holding,   holding,    faulted, holding},
      {faulted,   faulted, faulted,   faulted,  faulted,  faulted,   faulted,    faulted, idle},
      // clang-format on
  }};
}();

[[nodiscard]] constexpr Mode next_mode(Mode mode, Event event) noexcept {
  return kTransitions[static_cast<std::size_t>(mode)][static_cast<std::size_t>(event)];
}

/// Faults below 50 stop the arm that has them; the others are shown and recorded.
[[nodiscard]] constexpr bool stops_the_arm(Fault fault) noexcept {
  return fault != Fault::none && static_cast<int>(fault) < 50;
}

/// Decides when the two tools are coupled, how strongly, and from which references.
///
/// Positions and references travel absolute, each packet with the sender's reference x_0 and the
/// number of its epoch; references of one epoch belong together. Only the master begins an epoch:
/// at first engaging, after a clutch, when the peer's program restarted, or when the peer returns
/// and |e| is beyond the resync limit. The slave takes its own reference when it sees a new number.
/// Coupling rises only while both sides publish the same epoch and both are engaging or engaged. A
/// side that takes no part publishes epoch 0. References change only at ramp 0, and the law sees
/// only peer states of the own epoch: the force ramp · f(e) never jumps. docs/theory.md has the
/// protocol and why it cannot lock up.
///
/// Thread: the loop's only. Loop: step neither allocates, blocks nor throws.
class Supervisor {
 public:
  struct Config {
    double engage_ms = 300.0;       ///< ramp from 0 to 1
    double release_ms = 8.0;        ///< ramp from 1 to 0
    double link_timeout_ms = 10.0;  ///< on the upper bound of the age of the peer's state
    double resync_limit_mm = 10.0;  ///< largest |e| that a returning peer is coupled with
  };

  struct State {
    Mode mode = Mode::idle;
    bool enabled = false;
    bool clutch = false;                  ///< the own operator held it in the last step
    bool resync = false;                  ///< this side is the master and owes a new epoch
    double ramp = 0.0;                    ///< share of the coupling that is on
    std::uint32_t epoch = 0;              ///< of the own reference, 0 none
    Vector3 reference = Vector3::Zero();  ///< x_0 in the own base, m
    std::uint64_t peer_session = 0;       ///< of the newest sample, 0: no peer seen yet
    PeerState peer{};                     ///< newest of the own epoch
    Fault fault = Fault::none;            ///< why `faulted`
  };

  /// What one turn of the loop knows.
  struct Input {
    Instant now{};
    Vector3 p_BT = Vector3::Zero();    ///< own tool, m
    std::optional<PeerSample> peer{};  ///< newest so far, also when it came in an earlier turn
    bool clutch = false;               ///< the own operator holds it
    Fault fault = Fault::none;         ///< the device's or a computation's
    bool enable = false;               ///< requests of this turn
    bool disable = false;
    bool reset = false;
  };

  /// What this turn does. `epoch`, `reference` and `mode` go to the peer.
  struct Output {
    Mode mode = Mode::idle;
    bool amplifiers = false;
    double ramp = 0.0;
    Vector3 reference = Vector3::Zero();
    std::uint32_t epoch = 0;    ///< published: 0 while not enabled
    PeerState peer{};           ///< the state that the law may use while ramp > 0
    bool epoch_agreed = false;  ///< the newest peer state has the own epoch: `peer` is that state
    bool peer_fresh = false;
    Fault fault = Fault::none;  ///< own fault, or peer_faulted
    Limits limits{};            ///< peer_silent
  };

  /// `session` tells this run of the program from others, as in its packets: a master counts its
  /// epochs from 1 + 1000 (session mod 4 million), so that a peer that has not yet noticed a
  /// restart does not seem to agree.
  /// @throws ConfigError unless every number is positive and finite.
  Supervisor(const Config& config, const PositionError& law, std::uint64_t session);

  /// One turn, `dt` seconds after the one before.
  Output step(const Input& input, double dt) noexcept;

  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  void apply(Event event) noexcept { state_.mode = next_mode(state_.mode, event); }
  void hear_requests(const Input& input) noexcept;
  void owe_epoch() noexcept { state_.resync = law_.role() == Role::master; }
  void hear_session(const Input& input) noexcept;
  void agree_on_epoch(const Input& input, const PeerState* peer) noexcept;
  void renew_reference(const Vector3& p_BT, const PeerState& peer) noexcept;
  void take_reference(const Vector3& p_BT, std::uint32_t epoch) noexcept;
  [[nodiscard]] bool too_far_apart(const Vector3& p_BT, const PeerState& peer) const noexcept;
  [[nodiscard]] bool agrees(const PeerState* peer) const noexcept;
  void advance(const PeerState* peer, double dt) noexcept;
  [[nodiscard]] std::uint32_t published_epoch() const noexcept {
    return state_.enabled ? state_.epoch : 0;
  }

  Config config_;
  PositionError law_;
  std::uint32_t first_epoch_;
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, Supervisor::Config& config);

}  // namespace teleop
