#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace teleop {

/// What went wrong inside the loop. 1–49 stop the arm that has them (`faulted`: motor torques zero,
/// amplifiers off), 50–99 are shown and recorded. docs/faults.md has a row each. The numbers are
/// part of the log format.
enum class Fault : std::uint8_t {
  none = 0,
  device_unplugged = 1,      ///< the device no longer answers
  encoder_frozen = 2,        ///< counts stand still although torque should move the arm
  state_not_finite = 3,      ///< the device or a computation delivered NaN or infinity
  device_watchdog = 4,       ///< the device dropped its torque because writes came too late
  joint_speed_exceeded = 5,  ///< faster than the arm can be: a sensing fault or a runaway
  encoder_jump = 6,          ///< counts moved further in one tick than the arm can
  recording_failed = 50,     ///< shown and recorded; the loop goes on
  peer_faulted = 51,         ///< the other side is in `faulted`; this side holds
};

/// What a tick was cut to, or how it departed from the ideal. Bits of TickRecord::limits; the
/// recorded code is 100 + bit number.
enum class Limit : std::uint8_t {
  force = 0,           ///< 100: tool force cut, direction kept
  torque = 1,          ///< 101: joint torque cut, direction kept
  slew = 2,            ///< 102: torque change per tick cut, direction kept
  joint_range = 3,     ///< 103: at or beyond a joint or coupled limit
  device_torque = 4,   ///< 104: the device cut the torque further
  overrun = 5,         ///< 105: the previous turn ran past its period
  peer_silent = 6,     ///< 106: no fresh packet within the timeout
  record_dropped = 7,  ///< 107: the recording ring was full, a tick is missing in the log
  workspace = 8,       ///< 108: tool outside the declared workspace
};

/// One bit a Limit.
class Limits {
 public:
  constexpr void set(Limit limit) noexcept { bits_ |= bit(limit); }
  [[nodiscard]] constexpr bool has(Limit limit) const noexcept { return (bits_ & bit(limit)) != 0; }
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }
  constexpr void merge(Limits other) noexcept { bits_ |= other.bits_; }

 private:
  static constexpr std::uint32_t bit(Limit limit) noexcept {
    return std::uint32_t{1} << static_cast<unsigned>(limit);
  }
  std::uint32_t bits_ = 0;
};

/// A row of the fault table, as printed, logged and documented.
struct FaultText {
  int code = 0;            ///< 1–99 faults, 100– limits
  std::string_view name;   ///< as in the enum
  std::string_view cause;  ///< in words
};

[[nodiscard]] std::span<const FaultText> fault_table() noexcept;
[[nodiscard]] std::string_view name_of(Fault fault) noexcept;
[[nodiscard]] std::string_view name_of(Limit limit) noexcept;

}  // namespace teleop
