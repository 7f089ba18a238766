#include "core/device/device.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

std::unique_ptr<Arm> open_simulated(const std::string& plant, const DeviceContext& context) {
  return std::make_unique<SimulatedArm>(
      SimulatedArm::Config{.plant = load_plant(plant.empty() ? "phantom-1.5" : plant),
                           .hand = context.hand,
                           .contact = environment(context.environment),
                           .seed = context.seed},
      context.clock);
}

}  // namespace

std::unique_ptr<Arm> open_device(const std::string& name, const DeviceContext& context) {
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (kind == "sim") return open_simulated(rest, context);
  throw DeviceError{fmt::format("device '{}': no such kind; there is sim[:plant.toml]", name)};
}

}  // namespace teleop
