#pragma once

#include <cstdint>
#include <string>

#include "core/ports/peer.hpp"
#include "core/realtime/scheduling.hpp"
#include "core/station/station.hpp"

namespace teleop {

/// Everything that one side's process can be told, besides its link.
struct SideConfig {
  std::string device = "sim";
  std::string hand;  ///< of a simulated device: trace file, "reach", "press" or "none"
  std::string environment = "free";  ///< of a simulated device: free, soft or wall
  std::uint64_t seed = 1;
  double seconds = 0.0;      ///< 0: until stopped
  std::string out;           ///< folder of the recording; empty: none
  bool status_json = false;  ///< status lines as JSON on stdout
  Realtime realtime{};
  StationConfig station{};
};

void add_settings(Settings& settings, SideConfig& config);

}  // namespace teleop
