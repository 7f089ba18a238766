#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// Longest delay of a command or a reading, s.
inline constexpr double kMaxDelay_s = 0.05;

/// A list of small fixed capacity, so that terms can be copied into a loop.
template <class T, std::size_t kCapacity>
class ShortList {
 public:
  /// False when there is no room.
  [[nodiscard]] bool push(const T& item) noexcept {
    if (size_ == kCapacity) return false;
    items_[size_++] = item;
    return true;
  }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const T* begin() const noexcept { return items_.data(); }
  [[nodiscard]] const T* end() const noexcept { return items_.data() + size_; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t size_ = 0;
};

/// Friction of one joint, all its effects summed. It opposes the motion of the drive side:
///
///     f = −(dry_forward  + rise(q̇) + viscous_forward  q̇) − z   q̇ > 0
///     f = +(dry_backward + rise(q̇) − viscous_backward q̇) − z   q̇ < 0
///     f + z ∈ [−dry_forward − rise(0), dry_backward + rise(0)]  q̇ = 0: whatever keeps it at rest
///
/// rise(v) = stribeck_rise exp(−(v / stribeck_velocity)²); z is the bristle's torque.
struct JointFriction {
  /// Presliding as a bristle that bends before it slips [Dahl 1968; Canudas de Wit 1995]:
  ///
  ///     ż = stiffness (v − |v| z / g(v)),   torque −z − micro_damping ż / stiffness,
  ///     g(v) = level + (static_level − level) exp(−(v / stribeck_velocity)²)
  ///
  /// Dahl's is the case static_level = level, micro_damping = 0.
  struct Bristle {
    double level = 0.0;              ///< N m, 0: no bristle
    double static_level = 0.0;       ///< N m
    double stribeck_velocity = 1.0;  ///< rad/s
    double stiffness = 0.0;          ///< N m/rad
    double micro_damping = 0.0;      ///< N m s/rad
  };

  double dry_forward = 0.0;        ///< N m
  double dry_backward = 0.0;       ///< N m
  double viscous_forward = 0.0;    ///< N m s/rad
  double viscous_backward = 0.0;   ///< N m s/rad
  double stribeck_rise = 0.0;      ///< static less Coulomb level, N m
  double stribeck_velocity = 1.0;  ///< rad/s
  Bristle bristle{};

  /// Largest torque that a joint at rest takes up before it moves forward or backward, N m.
  [[nodiscard]] constexpr double stick_forward() const noexcept {
    return dry_forward + stribeck_rise;
  }
  [[nodiscard]] constexpr double stick_backward() const noexcept {
    return dry_backward + stribeck_rise;
  }

  /// The law has a corner at rest, so a change of direction is an event.
  [[nodiscard]] constexpr bool has_corner() const noexcept {
    return dry_forward > 0.0 || dry_backward > 0.0 || viscous_forward != viscous_backward ||
           stribeck_rise > 0.0 || bristle.level > 0.0;
  }
};

/// What stands between the motor and the link of one axis. Where it gives way, the drive side with
/// inertia J has an angle m of its own and the link keeps M less J.
struct Transmission {
  enum class Kind { rigid, compliant, play };
  Kind kind = Kind::rigid;
  double stiffness = 0.0;      ///< N m/rad
  double damping = 0.0;        ///< N m s/rad
  double gap = 0.0;            ///< rad, total width of the play
  double drive_inertia = 0.0;  ///< J, kg m²
};

/// A one-sided wall in one joint: with p = side (q − location) > 0 the torque on the link is
/// −side max(0, stiffness p + damping ṗ).
struct JointWall {
  std::size_t axis = 0;
  double location = 0.0;   ///< rad
  double stiffness = 0.0;  ///< N m/rad
  double damping = 0.0;    ///< N m s/rad
  double side = 1.0;       ///< +1: above the location
};

/// amplitude sin(frequency m + phase), as torque (N m) or as reading (rad) over the drive's angle.
struct AngleWave {
  double amplitude = 0.0;
  double frequency = 0.0;  ///< rad/rad
  double phase = 0.0;
};

/// From the command to the torque of one axis, in this order: delay, saturation, dead zone, gain
/// with thermal loss, lag; then bias, ripple and coupling are added.
struct ActuationTerms {
  double delay = 0.0;  ///< s
  double limit = std::numeric_limits<double>::infinity();
  double threshold = 0.0;
  double gain = 1.0;
  double loss = 0.0;
  double thermal_time_constant = 1.0;  ///< s
  double lag = 0.0;                    ///< s, time constant
  double bias = 0.0;
  ShortList<AngleWave, 4> ripple{};
  std::array<double, kJoints> coupling{};  ///< share of the commands of all axes
};

/// What the tool carries and how the base stands.
struct LoadTerms {
  double payload_kg = 0.0;
  double tilt_x = 0.0;                          ///< rad
  double tilt_z = 0.0;                          ///< rad
  std::array<double, kJoints> added_inertia{};  ///< kg m²
  double grip_stiffness = 0.0;                 ///< N/m, of a hand that holds the tool at grip_point
  double grip_damping = 0.0;                   ///< N s/m
  double grip_mass = 0.0;                      ///< kg, without weight
  std::array<double, kJoints> grip_posture{};  ///< whose tool position is the grip's point

  [[nodiscard]] bool has_grip() const noexcept {
    return grip_stiffness > 0.0 || grip_damping > 0.0;
  }
};

/// Motor and amplifier of one axis, electrically; the torque constant and the transmission are the
/// arm's. With motor current i, winding resistance R and back-EMF K_e N ṁ:  L i̇ = V − R i − K_e N
/// ṁ.
struct MotorTerms {
  enum class Drive {
    ideal,   ///< the commanded torque, whatever the motor does
    linear,  ///< a current loop of first order within limits of current and voltage
    pwm,     ///< a voltage switched between supply and zero, duty = command / stall torque
  };
  Drive drive = Drive::ideal;
  double resistance_ohm = 2.32;
  double inductance_H = 2.4e-4;
  double bandwidth_Hz = 0.0;     ///< of the linear amplifier
  double current_limit_A = 0.0;  ///< of the linear amplifier
  double voltage_limit_V = 0.0;  ///< of the linear amplifier
  double supply_V = 0.0;         ///< of the PWM drive
  double carrier_Hz = 0.0;       ///< of the PWM drive
  AngleWave commutation{};       ///< of the resistance, as a share of it, over the joint angle

  bool heats = false;
  double ambient_C = 25.0;
  double winding_to_housing_K_per_W = 0.0;
  double housing_to_ambient_K_per_W = 0.0;
  double winding_J_per_K = 0.0;
  double housing_J_per_K = 0.0;
  double copper_per_K = 0.0;  ///< rise of the resistance
  double magnet_per_K = 0.0;  ///< fall of the torque constant with the housing's temperature
};

/// What the encoder of one axis makes of the drive's angle m: y = scale m + waves, read late.
struct SensingTerms {
  double scale = 1.0;
  ShortList<AngleWave, 4> waves{};
  double delay = 0.0;                ///< s
  double phase_error = 0.0;          ///< of channel B, as a share of a count
  double duty_error = 0.0;           ///< of the falling edges, as a share of a count
  double steps_per_line = 4.0;       ///< 4: quadrature; more: an interpolated sine encoder
  double interpolation_error = 0.0;  ///< amplitude over one line, as a share of the line
  double tendon_stiffness =
      0.0;  ///< N m/rad of the tendon that carries the motor's reaction, 0: rigid
};

/// An accelerometer at the tool.
struct AccelerometerTerms {
  bool fitted = false;
  double noise = 0.0;         ///< m/s² RMS a reading
  double bandwidth_Hz = 0.0;  ///< first order
  double range = 0.0;         ///< m/s²
};

/// What a list of effects adds to the rigid body, summed over the effects once and for all, so
/// that a step costs the same whatever the length of the list.
struct PlantTerms {
  std::array<JointFriction, kJoints> friction{};
  std::array<Transmission, kJoints> transmission{};
  std::array<ActuationTerms, kJoints> actuation{};
  std::array<MotorTerms, kJoints> motor{};
  std::array<SensingTerms, kJoints> sensing{};
  std::array<double, kJoints> spring_stiffness{};  ///< of cables on the links, N m/rad
  std::array<double, kJoints> spring_torque{};     ///< of the same at angle zero, N m
  ShortList<JointWall, 6> walls{};
  LoadTerms load{};
  AccelerometerTerms accelerometer{};
  double time_ratio = 1.0;  ///< true over stated time
};

}  // namespace teleop
