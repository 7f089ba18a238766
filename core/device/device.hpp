#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"

namespace teleop {

/// What a device may need besides its own name. Hand, environment and seed serve simulated arms.
struct DeviceContext {
  Clock& clock;
  std::string hand = "none";         ///< as for make_hand()
  std::string environment = "free";  ///< as for environment()
  std::uint64_t seed = 1;
};

/// The one factory of arms: what every `--device`, `--master` and `--slave` means.
///
///     sim             the simulated arm, plant "phantom-1.5"
///     sim:PLANT       the same with a plant file or the name of a shipped plant
///
/// @throws DeviceError for a kind that does not exist, ConfigError for bad files.
[[nodiscard]] std::unique_ptr<Arm> open_device(const std::string& name,
                                               const DeviceContext& context);

}  // namespace teleop
