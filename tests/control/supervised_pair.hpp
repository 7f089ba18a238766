#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/control/supervisor.hpp"

namespace teleop::testing {

/// One side as the supervisor sees it: a tool that a test moves, and the requests of the next turn.
struct SupervisedSide {
  explicit SupervisedSide(Role side, const Supervisor::Config& times = {})
      : role{side}, config{times}, supervisor{times, PositionError{{}, side}, session} {}

  /// A new process in the place of the old one.
  void restart() {
    ++session;
    supervisor = Supervisor{config, PositionError{{}, role}, session};
    newest.reset();
    latched_in = 0;
    out = {};
  }

  void turn(Instant now, double dt) {
    Supervisor::Input input{.now = now,
                            .p_BT = p,
                            .peer = newest,
                            .clutch = clutch,
                            .fault = fault,
                            .enable = enable,
                            .disable = disable,
                            .reset = reset};
    const std::uint32_t epoch_before = supervisor.state().epoch;
    out = supervisor.step(input, dt);
    const Supervisor::State& state = supervisor.state();
    if (state.epoch != epoch_before && state.epoch != 0) latched_in = state.peer_session;
    enable = disable = reset = false;
  }

  [[nodiscard]] PeerSample packet() const {
    PeerSample sample;
    sample.state.tick = latched_in;
    sample.state.p_BT = p;
    sample.state.reference = out.reference;
    sample.state.epoch = out.epoch;
    sample.state.mode = out.mode;
    sample.state.fault = out.fault;
    sample.state.clutch = clutch;
    sample.session = session;
    return sample;
  }

  Role role;
  Supervisor::Config config;
  std::uint64_t session = 1;
  Supervisor supervisor;
  Supervisor::Output out{};
  std::optional<PeerSample> newest{};
  std::uint64_t latched_in = 0;  ///< the peer's session when the own reference was taken; travels
                                 ///< as the tick, which the supervisor does not look at
  Vector3 p = Vector3::Zero();
  bool clutch = false;
  Fault fault = Fault::none;
  bool enable = false;
  bool disable = false;
  bool reset = false;
};

/// Both sides in step at 1 kHz; a packet arrives before the receiver's next turn.
struct SupervisedPair {
  explicit SupervisedPair(const Supervisor::Config& times = {})
      : master{Role::master, times}, slave{Role::slave, times} {}

  [[nodiscard]] static SupervisedPair engaged(const Supervisor::Config& times = {}) {
    SupervisedPair pair{times};
    pair.enable_both();
    pair.run(400);
    return pair;
  }

  void enable_both() { master.enable = slave.enable = true; }

  void run(int ticks) {
    for (int k = 0; k < ticks; ++k) {
      now += std::chrono::milliseconds{1};
      master.turn(now, 1e-3);
      slave.turn(now, 1e-3);
      if (!connected) continue;
      deliver(master, slave);
      deliver(slave, master);
    }
  }

  void deliver(const SupervisedSide& from, SupervisedSide& to) const {
    to.newest = from.packet();
    to.newest->received = now;
  }

  SupervisedSide master;
  SupervisedSide slave;
  Instant now{};
  bool connected = true;
};

}  // namespace teleop::testing
