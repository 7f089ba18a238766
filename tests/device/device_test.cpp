#include "core/device/device.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

TEST(Device, OpensTheSimulatedArmAndAsksForNoMoreThanAName) {
  SimulatedClock clock;
  const auto arm = open_device("sim", {.clock = clock});
  EXPECT_EQ(arm->info().model, "phantom-1.5");
  EXPECT_TRUE(arm->info().simulated);
  EXPECT_EQ(arm->read().q, JointVector::Zero());
}

TEST(Device, RefusesAKindThatDoesNotExist) {
  SimulatedClock clock;
  EXPECT_THROW((void)open_device("teapot", {.clock = clock}), DeviceError);
  EXPECT_THROW((void)open_device("", {.clock = clock}), DeviceError);
  EXPECT_THROW((void)open_device("sim:no-such-plant.toml", {.clock = clock}), ConfigError);
}

}  // namespace
}  // namespace teleop
