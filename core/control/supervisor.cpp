#include "core/control/supervisor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr double kPerMilli = 1e-3;

bool is_positive(double value) noexcept { return std::isfinite(value) && value > 0.0; }

bool couples(Mode mode) noexcept { return mode == Mode::engaging || mode == Mode::engaged; }

}  // namespace

Supervisor::Supervisor(const Config& config, const PositionError& law, std::uint64_t session)
    : config_{config},
      law_{law},
      first_epoch_{static_cast<std::uint32_t>(1 + 1000 * (session % 4'000'000))} {
  owe_epoch();
  if (!is_positive(config.engage_ms) || !is_positive(config.release_ms) ||
      !is_positive(config.link_timeout_ms) || !is_positive(config.resync_limit_mm)) {
    throw ConfigError{"supervisor: every time and limit must be more than 0 and finite"};
  }
}

Supervisor::Output Supervisor::step(const Input& input, double dt) noexcept {
  hear_requests(input);
  hear_session(input);
  const bool fresh = input.peer && seconds(input.peer->age_bound(input.now)) <=
                                       config_.link_timeout_ms * kPerMilli;
  const PeerState* peer = fresh ? &input.peer->state : nullptr;
  agree_on_epoch(input, peer);
  advance(peer, dt);

  Output out{.mode = state_.mode,
             .amplifiers = state_.enabled || state_.ramp > 0.0,
             .ramp = state_.ramp,
             .reference = state_.reference,
             .epoch = published_epoch(),
             .peer = state_.peer,
             .epoch_agreed = agrees(peer),
             .peer_fresh = fresh,
             .fault = state_.fault};
  if (out.fault == Fault::none) out.fault = input.fault;
  if (out.fault == Fault::none && fresh && peer->mode == Mode::faulted) {
    out.fault = Fault::peer_faulted;
  }
  if (!fresh && state_.enabled) out.limits.set(Limit::peer_silent);
  return out;
}

/// Reset comes first, so that a fault that is still there is seen at once; enable comes last, so
/// that one turn can reset and enable.
void Supervisor::hear_requests(const Input& input) noexcept {
  if (input.reset) {
    apply(Event::reset);
    state_.fault = Fault::none;
  }
  if (stops_the_arm(input.fault)) {
    apply(Event::fault);
    if (state_.fault == Fault::none) state_.fault = input.fault;
  }
  if (input.disable) apply(Event::disable);
  if (input.enable && !input.disable) apply(Event::enable);
  state_.enabled = (state_.enabled || input.enable) && !input.disable;

  if (state_.mode == Mode::faulted) {
    state_.enabled = false;
    state_.ramp = 0.0;
  }
  if (input.clutch != state_.clutch) {
    apply(input.clutch ? Event::clutch_pressed : Event::clutch_released);
  }
  state_.clutch = input.clutch;
}

/// A slave that restarted stands somewhere else, whatever epoch it says.
void Supervisor::hear_session(const Input& input) noexcept {
  if (!input.peer || input.peer->session == state_.peer_session) return;
  state_.peer_session = input.peer->session;
  owe_epoch();
}

void Supervisor::agree_on_epoch(const Input& input, const PeerState* peer) noexcept {
  const bool clutched = input.clutch || (peer != nullptr && peer->clutch);
  if (clutched) owe_epoch();
  if (peer == nullptr || !state_.enabled) return;
  if (!clutched && state_.ramp == 0.0) renew_reference(input.p_BT, *peer);
  if (agrees(peer)) state_.peer = *peer;
}

void Supervisor::renew_reference(const Vector3& p_BT, const PeerState& peer) noexcept {
  if (law_.role() == Role::slave) {
    if (peer.epoch != 0 && peer.epoch != state_.epoch) take_reference(p_BT, peer.epoch);
    return;
  }
  if (agrees(&peer) && too_far_apart(p_BT, peer)) owe_epoch();
  if (state_.resync) take_reference(p_BT, state_.epoch == 0 ? first_epoch_ : state_.epoch + 1);
}

void Supervisor::take_reference(const Vector3& p_BT, std::uint32_t epoch) noexcept {
  state_.reference = p_BT;
  state_.epoch = epoch;
  state_.resync = false;
}

bool Supervisor::too_far_apart(const Vector3& p_BT, const PeerState& peer) const noexcept {
  const auto coupling =
      law_.step({.displacement = p_BT - state_.reference, .velocity = Vector3::Zero()},
                {.displacement = peer.p_BT - peer.reference, .velocity = Vector3::Zero()});
  // Written so that a position that is no number counts as too far.
  return !(coupling.error.norm() <= config_.resync_limit_mm * kPerMilli);
}

bool Supervisor::agrees(const PeerState* peer) const noexcept {
  const std::uint32_t own = published_epoch();
  return peer != nullptr && own != 0 && peer->epoch == own && !state_.resync;
}

/// Mode and ramp from what the peer says. A side at ramp 0 waits in `engaging` for its peer; once
/// its ramp has left 0, a peer that does not couple means that this side lets go too.
void Supervisor::advance(const PeerState* peer, double dt) noexcept {
  const bool ready = agrees(peer) && !state_.clutch && !peer->clutch;
  const bool coupled = ready && couples(peer->mode);
  const bool waits = ready && state_.ramp == 0.0;
  if (waits) apply(Event::peer_ready);
  if (!coupled && !waits) apply(Event::peer_lost);

  if (couples(state_.mode) && coupled) {
    state_.ramp = std::min(1.0, state_.ramp + dt / (config_.engage_ms * kPerMilli));
  } else {
    state_.ramp = std::max(0.0, state_.ramp - dt / (config_.release_ms * kPerMilli));
    if (state_.ramp < 1e-9) state_.ramp = 0.0;  // what rounding leaves must not delay the end
  }
  if (state_.ramp == 1.0) apply(Event::ramp_done);
}

void add_settings(Settings& settings, const std::string& prefix, Supervisor::Config& config) {
  settings.add(prefix + "engage_ms", &config.engage_ms, "coupling rises from 0 to 1 in this time",
               {.low = 1.0, .high = 1e4});
  settings.add(prefix + "release_ms", &config.release_ms, "coupling falls from 1 to 0 in this time",
               {.low = 1.0, .high = 1e3});
  settings.add(prefix + "link_timeout_ms", &config.link_timeout_ms,
               "a peer state that may be older than this is silence", {.low = 1.0, .high = 1e4});
  settings.add(prefix + "resync_limit_mm", &config.resync_limit_mm,
               "new references when a peer returns with a larger error", {.low = 0.1, .high = 1e3});
}

}  // namespace teleop
