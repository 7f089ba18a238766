#pragma once

#include <string>

#include "core/realtime/clock.hpp"
#include "core/simulation/arm_sim.hpp"
#include "core/simulation/network.hpp"
#include "core/station/station.hpp"

namespace teleop {

/// Both sides of a teleoperator on simulated time: two simulated arms, two stations, the network
/// between them, one clock. What two processes do on real time happens here in one thread, a turn
/// of the master, half a period later a turn of the slave, so that each hears the other's newest
/// packet half a period old, the mean of two loops that nobody synchronised.
///
/// Same configuration, same records, bit by bit.
class SimulatedPair {
 public:
  struct Config {
    SimulatedArm::Config master{};
    SimulatedArm::Config slave{};
    StationConfig station{};         ///< of both
    Duration network_delay{20'000};  ///< each way
  };

  /// @throws ConfigError as its parts do.
  explicit SimulatedPair(const Config& config);

  /// One turn of each side.
  void step() noexcept;

  [[nodiscard]] const TickRecord& master() const noexcept { return *master_record_; }
  [[nodiscard]] const TickRecord& slave() const noexcept { return *slave_record_; }
  [[nodiscard]] SimulatedArm& master_arm() noexcept { return master_arm_; }
  [[nodiscard]] SimulatedArm& slave_arm() noexcept { return slave_arm_; }
  [[nodiscard]] SimulatedNetwork& network() noexcept { return network_; }
  [[nodiscard]] Clock& clock() noexcept { return clock_; }

 private:
  [[nodiscard]] Tick tick() noexcept;

  SimulatedClock clock_;
  Duration period_;
  SimulatedArm master_arm_;
  SimulatedArm slave_arm_;
  SimulatedNetwork network_;
  Station master_;
  Station slave_;
  Instant due_{};
  std::uint64_t index_ = 0;
  const TickRecord* master_record_ = nullptr;
  const TickRecord* slave_record_ = nullptr;
};

}  // namespace teleop
