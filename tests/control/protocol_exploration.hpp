#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "tests/control/supervised_pair.hpp"

namespace teleop::testing {

/// Both supervisors and a link that may delay, lose and replace packets at will. Coarse times keep
/// the number of states small: the ramp knows 0, ½ and 1, and a packet is silence after two turns.
struct ProtocolWorld {
  static constexpr Supervisor::Config kTimes{
      .engage_ms = 2.0, .release_ms = 2.0, .link_timeout_ms = 1.0, .resync_limit_mm = 10.0};
  static constexpr int kSilent = 2;

  std::array<SupervisedSide, 2> side{SupervisedSide{Role::master, kTimes},
                                     SupervisedSide{Role::slave, kTimes}};
  std::array<int, 2> age{kSilent, kSilent};           ///< of each side's newest sample, turns
  std::array<std::optional<PeerSample>, 2> flight{};  ///< on the way from each side
  int restarts = 0;                                   ///< of either program, so far

  /// A turn of one side; its packet is not yet sent.
  void turn(std::size_t i) {
    age.at(i) = std::min(age.at(i) + 1, kSilent);
    side.at(i).turn(Instant{} + std::chrono::milliseconds{age.at(i)}, 1e-3);
  }

  void deliver(std::size_t from) {
    if (!flight.at(from)) return;
    PeerSample arrived = *flight.at(from);
    arrived.received = Instant{};
    side.at(1 - from).newest = arrived;
    age.at(1 - from) = 0;
    flight.at(from).reset();
  }

  /// A live link and operators that only want to go on: does everybody get to `engaged`?
  [[nodiscard]] bool gets_engaged(bool slave_first) const {
    ProtocolWorld world = *this;
    for (SupervisedSide& s : world.side)
      s.clutch = false;
    const auto both_engaged = [&] {
      return world.side[0].out.mode == Mode::engaged && world.side[1].out.mode == Mode::engaged;
    };
    for (int round = 0; round < 20 && !both_engaged(); ++round) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t i = slave_first ? 1 - k : k;
        SupervisedSide& s = world.side.at(i);
        s.reset = s.out.mode == Mode::faulted;
        s.enable = true;
        world.deliver(1 - i);
        world.turn(i);
        world.flight.at(i) = s.packet();
      }
    }
    return both_engaged();
  }

  /// What tells two worlds apart: epochs matter by their order alone.
  [[nodiscard]] std::string key() const;
};

/// Which things may go wrong during an exploration.
struct ProtocolActions {
  bool clutches = false;
  bool motion = false;  ///< the master's tool jumps beyond the resync limit and back
  bool faults = false;  ///< and reset and enable
  bool disabling = false;
  int restarts = 0;  ///< at most so many
};

/// Visits every world reachable by any interleaving of turns, deliveries, losses and `actions`.
/// `visit(before, after)` is called once a transition, `reached(world)` once a new world.
/// @returns the number of worlds.
template <class Visit, class Reached>
std::size_t explore(const ProtocolActions& actions, Visit&& visit, Reached&& reached);

// ---------------------------------------------------------------------------------------------

inline std::string ProtocolWorld::key() const {
  std::vector<std::uint32_t> epochs;
  const auto collect = [&](const std::optional<PeerSample>& s) {
    if (s) epochs.push_back(s->state.epoch);
  };
  for (std::size_t i = 0; i < 2; ++i) {
    epochs.push_back(side.at(i).supervisor.state().epoch);
    collect(side.at(i).newest);
    collect(flight.at(i));
  }
  std::ranges::sort(epochs);
  epochs.erase(std::unique(epochs.begin(), epochs.end()), epochs.end());

  std::string key;
  const auto put = [&](auto value) {
    key.push_back(static_cast<char>(value));
  };
  const auto put_epoch = [&](std::uint32_t epoch) {
    if (epoch == 0) return put(0);
    const bool zero_is_one_of_them = epochs.front() == 0;
    put(std::ranges::lower_bound(epochs, epoch) - epochs.begin() + (zero_is_one_of_them ? 0 : 1));
  };
  const auto put_sample = [&](const std::optional<PeerSample>& s) {
    put(s.has_value());
    if (!s) return;
    put_epoch(s->state.epoch);
    put(s->state.mode);
    put(s->state.clutch);
    put(s->session);
    put(s->state.tick);
    put(s->state.p_BT.x() > 0.05);
    put(s->state.reference.x() > 0.05);
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const Supervisor::State& s = side.at(i).supervisor.state();
    put(s.mode);
    put(2 * s.enabled + s.clutch);
    put(s.resync);
    put(2.0 * s.ramp);
    put_epoch(s.epoch);
    put(s.reference.x() > 0.05);
    put(s.peer_session);
    put(side.at(i).latched_in);
    put(side.at(i).p.x() > 0.05);
    put(2 * side.at(i).session + side.at(i).clutch);
    put(age.at(i));
    // Silent samples count for their session alone.
    if (age.at(i) < kSilent) put_sample(side.at(i).newest);
    put_sample(flight.at(i));
  }
  put(restarts);
  return key;
}

namespace detail {

/// Every world that one action makes of `world`.
template <class Emit>
void successors(const ProtocolWorld& world, const ProtocolActions& actions, Emit&& emit) {
  for (std::size_t i = 0; i < 2; ++i) {
    const auto turned = [&](auto&& prepare) {
      ProtocolWorld next = world;
      prepare(next.side.at(i));
      next.turn(i);
      next.side.at(i).fault = Fault::none;
      ProtocolWorld sent = next;
      sent.flight.at(i) = next.side.at(i).packet();
      emit(std::move(sent));
      if (world.flight.at(i)) emit(std::move(next));  // this packet is lost, the older arrives
    };
    turned([](SupervisedSide&) {});
    turned([](SupervisedSide& s) { s.enable = true; });
    if (actions.disabling) turned([](SupervisedSide& s) { s.disable = true; });
    if (actions.clutches) turned([](SupervisedSide& s) { s.clutch = !s.clutch; });
    if (actions.faults) turned([](SupervisedSide& s) { s.fault = Fault::encoder_jump; });
    if (actions.faults) turned([](SupervisedSide& s) { s.reset = s.enable = true; });
    if (world.flight.at(i)) {
      ProtocolWorld next = world;
      next.deliver(i);
      emit(std::move(next));
    }
    if (world.restarts < actions.restarts) {
      ProtocolWorld next = world;
      next.side.at(i).restart();
      next.side.at(i).p.x() = 0.1;  // and the arm stands elsewhere
      next.age.at(i) = ProtocolWorld::kSilent;
      ++next.restarts;
      emit(std::move(next));
    }
  }
  if (actions.motion) {
    ProtocolWorld next = world;
    next.side[0].p.x() = next.side[0].p.x() > 0.05 ? 0.0 : 0.1;
    emit(std::move(next));
  }
}

}  // namespace detail

template <class Visit, class Reached>
std::size_t explore(const ProtocolActions& actions, Visit&& visit, Reached&& reached) {
  std::unordered_set<std::string> seen;
  std::deque<ProtocolWorld> frontier;
  const auto meet = [&](ProtocolWorld world) {
    if (!seen.insert(world.key()).second) return;
    reached(world);
    frontier.push_back(std::move(world));
  };
  meet(ProtocolWorld{});
  while (!frontier.empty()) {
    const ProtocolWorld world = std::move(frontier.front());
    frontier.pop_front();
    detail::successors(world, actions, [&](ProtocolWorld next) {
      visit(world, next);
      meet(std::move(next));
    });
  }
  return seen.size();
}

}  // namespace teleop::testing
