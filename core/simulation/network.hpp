#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "core/base/time.hpp"
#include "core/ports/link.hpp"
#include "core/realtime/clock.hpp"

namespace teleop {

/// A link to nobody: for one arm alone.
class SilentLink final : public Link {
 public:
  [[nodiscard]] std::optional<PeerSample> receive() noexcept override { return std::nullopt; }
  void send(const PeerState& /*state*/) noexcept override { ++statistics_.sent; }
  [[nodiscard]] LinkStatistics statistics() const noexcept override { return statistics_; }
  [[nodiscard]] std::uint64_t session() const noexcept override { return 1; }

 private:
  LinkStatistics statistics_{};
};

/// Two links joined back to back on one clock, each way with a constant delay: what one side sends
/// the other receives `delay` later. An outage loses what is sent while it lasts.
///
/// Thread: one. Loop: no allocation.
class SimulatedNetwork {
 public:
  SimulatedNetwork(Clock& clock, Duration delay) noexcept;

  [[nodiscard]] Link& end(Role role) noexcept { return role == Role::master ? master_ : slave_; }

  /// Loses every packet sent from now on, or stops losing them.
  void outage(bool on) noexcept { outage_ = on; }

  /// The side starts anew: another session, sequence from zero.
  void restart(Role role) noexcept;

 private:
  class End final : public Link {
   public:
    End(SimulatedNetwork& network, std::uint64_t session) noexcept
        : network_{network}, session_{session} {}

    [[nodiscard]] std::optional<PeerSample> receive() noexcept override;
    void send(const PeerState& state) noexcept override;
    [[nodiscard]] LinkStatistics statistics() const noexcept override { return statistics_; }
    [[nodiscard]] std::uint64_t session() const noexcept override { return session_; }

   private:
    friend class SimulatedNetwork;
    static constexpr std::size_t kOnTheWay = 1024;

    SimulatedNetwork& network_;
    End* peer_ = nullptr;
    std::uint64_t session_;
    std::uint64_t sequence_ = 0;
    std::uint64_t last_received_ = 0;
    std::array<PeerSample, kOnTheWay> inbox_{};
    std::size_t first_ = 0;
    std::size_t count_ = 0;
    LinkStatistics statistics_{};
  };

  Clock& clock_;
  Duration delay_;
  bool outage_ = false;
  std::uint64_t sessions_ = 2;
  End master_{*this, 1};
  End slave_{*this, 2};
};

}  // namespace teleop
