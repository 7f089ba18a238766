#include "core/base/fault.hpp"

#include <array>

namespace teleop {
namespace {

constexpr std::array kTable{
    FaultText{1, "device_unplugged", "the device no longer answers"},
    FaultText{2, "encoder_frozen", "an encoder stands still although torque should move the arm"},
    FaultText{3, "state_not_finite", "the device or a computation delivered a number that is none"},
    FaultText{4, "device_watchdog", "the device dropped its torque because commands came too late"},
    FaultText{5, "joint_speed_exceeded", "a joint moved faster than the arm can"},
    FaultText{6, "encoder_jump", "counts moved further in one tick than the arm can"},
    FaultText{50, "recording_failed", "the recording could not be written; the loop went on"},
    FaultText{51, "peer_faulted", "the other side reported a fault"},
    FaultText{100, "force", "tool force cut to its limit, direction kept"},
    FaultText{101, "torque", "joint torque cut to its limit, direction kept"},
    FaultText{102, "slew", "change of torque cut to its limit, direction kept"},
    FaultText{103, "joint_range", "at or beyond a joint or coupled limit"},
    FaultText{104, "device_torque", "the device cut the torque further"},
    FaultText{105, "overrun", "the previous turn of the loop ran past its period"},
    FaultText{106, "peer_silent", "no fresh packet from the peer within the timeout"},
    FaultText{107, "record_dropped",
              "the recording ring was full and a tick is missing in the log"},
    FaultText{108, "workspace", "the tool is outside the declared workspace"},
};

std::string_view name_of_code(int code) noexcept {
  for (const FaultText& row : kTable) {
    if (row.code == code) return row.name;
  }
  return "none";
}

}  // namespace

std::span<const FaultText> fault_table() noexcept { return kTable; }

std::string_view name_of(Fault fault) noexcept { return name_of_code(static_cast<int>(fault)); }

std::string_view name_of(Limit limit) noexcept {
  return name_of_code(100 + static_cast<int>(limit));
}

}  // namespace teleop
