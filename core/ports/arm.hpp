#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/base/fault.hpp"
#include "core/base/time.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// Bits of ArmState::flags.
enum class ArmFlag : std::uint32_t {
  amplifiers_on = 1U << 0U,     ///< torque commands reach the motors
  watchdog_tripped = 1U << 1U,  ///< the device starved and dropped its torque
  torque_cut = 1U << 2U,        ///< the device cut the last command to its own limit
  has_currents = 1U << 3U,      ///< motor_current is measured
  has_temperatures = 1U << 4U,  ///< motor_temperature is measured
  has_tool_force = 1U << 5U,    ///< tool_force is measured (a simulated arm knows it exactly)
  has_period = 1U << 6U,        ///< period_ticks is measured
  has_acceleration = 1U << 7U,  ///< tool_acceleration is measured
};

/// What a device says at one instant. Everything that the device does not measure stays zero and
/// its flag is clear.
struct ArmState {
  Instant stamp{};                                      ///< when the encoders were latched
  std::array<std::int32_t, kJoints> counts{};           ///< raw encoder counts
  JointVector q = JointVector::Zero();                  ///< joint angles from the counts, rad
  std::array<std::int32_t, kJoints> period_ticks{};     ///< 10 MHz ticks between the last two
                                                        ///< edges, sign = direction, 0 = overflow
  JointVector motor_current = JointVector::Zero();      ///< A
  JointVector motor_temperature = JointVector::Zero();  ///< °C, casing
  Vector3 tool_force = Vector3::Zero();                 ///< force of hand and surroundings on the
                                                        ///< tool, in B, N
  Vector3 tool_acceleration = Vector3::Zero();          ///< in B, m/s², weight not included
  std::uint32_t switches = 0;                           ///< bit 0: stylus button (clutch)
  std::uint32_t flags = 0;                              ///< ArmFlag bits
  Fault fault = Fault::none;                            ///< what the device itself found

  [[nodiscard]] constexpr bool has(ArmFlag flag) const noexcept {
    return (flags & static_cast<std::uint32_t>(flag)) != 0;
  }
  constexpr void set(ArmFlag flag) noexcept { flags |= static_cast<std::uint32_t>(flag); }
};

/// What a device is. Fixed while it is open.
struct ArmInfo {
  std::string name;                                  ///< "sim", a serial number …
  std::string model;                                 ///< "phantom-1.5"
  JointVector counts_per_rev = JointVector::Zero();  ///< of the joint
  JointVector max_torque = JointVector::Zero();      ///< that the motors can give, N m
  std::string details;                               ///< plant, seed, firmware …
  bool simulated = false;                            ///< computes what a real arm does by itself
};

/// The port that every arm fits: a driver, a simulation, a replayed tape. It speaks joints, so that
/// estimators, heat and faults work on joints and laws on the tool.
///
/// Thread: the loop's only. read, write and amplifiers neither block, allocate nor throw.
class Arm {
 public:
  Arm() = default;
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;
  Arm(Arm&&) = delete;
  Arm& operator=(Arm&&) = delete;
  virtual ~Arm() = default;

  [[nodiscard]] virtual const ArmInfo& info() const noexcept = 0;
  [[nodiscard]] virtual ArmState read() noexcept = 0;

  /// Joint torques in N m, held until the next write. They reach the motors only while the
  /// amplifiers are on.
  virtual void write(const JointVector& tau) noexcept = 0;

  /// Off: motor torques are zero at once, whatever is written.
  virtual void amplifiers(bool on) noexcept = 0;
};

}  // namespace teleop
