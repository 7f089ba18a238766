#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/concealed/effect.hpp"

namespace teleop::concealed {

/// Seconds of true time from the start of a run.
struct Window {
  double start = 0.0;
  double end = 0.0;
};

/// amplitude sin(frequency x + phase)
struct Wave {
  double amplitude = 0.0;
  double frequency = 0.0;
  double phase = 0.0;

  [[nodiscard]] double at(double x) const noexcept;
};

/// From the command u to the torque a, in this order: delay, saturation, deadzone, gain with
/// thermal loss, lag; then bias, ripple and coupling are added.
struct ActuationLaw {
  double delay = 0.0;
  double limit = std::numeric_limits<double>::infinity();
  double threshold = 0.0;
  double gain = 1.0;
  double loss = 0.0;
  double heat_time = 1.0;
  double lag = 0.0;
  double bias = 0.0;
  Wave ripple{};                           ///< over the drive's angle
  std::array<double, kJoints> coupling{};  ///< shares of the undistorted commands
  Wave gain_wave{};                        ///< stranger: over time, added to the gain
  double rate_share = 0.0;  ///< stranger: of the torque, lost where the command changes fast
  double rate_scale = 1.0;  ///< N m/s where the loss is half of it
};

/// On the drive side; positive torques drive the joint forward.
struct FrictionLaw {
  double viscous = 0.0;
  double viscous_asymmetry = 0.0;
  double coulomb = 0.0;
  double coulomb_asymmetry = 0.0;
  double stribeck_coulomb = 0.0;
  double stribeck_static = 0.0;
  double stribeck_velocity = 1.0;
  double dahl_level = 0.0;
  double dahl_stiffness = 0.0;
  double drag = 0.0;             ///< stranger: −drag |ṁ| ṁ
  double growth = 0.0;           ///< stranger: Coulomb level that grows, N m/s
  double patch_level = 0.0;      ///< stranger: Coulomb level between two angles
  double patch_low = 0.0;        ///< rad
  double patch_high = 0.0;       ///< rad
  double patch_direction = 0.0;  ///< +1, −1: only against this direction; 0: both
  double catch_level = 0.0;      ///< stranger: Coulomb level within windows of time
  std::vector<Window> catches{};

  [[nodiscard]] bool dry() const noexcept;
  /// Largest torques against forward and backward motion.
  struct Levels {
    double forward = 0.0;
    double backward = 0.0;
  };
  [[nodiscard]] Levels levels(double t, double m, double speed) const noexcept;
  [[nodiscard]] double smooth(double speed) const noexcept;  ///< viscous and quadratic
};

/// Between drive and link. Split axes have a rotor of their own.
struct TransmissionLaw {
  bool split = false;
  bool play = false;
  double gap = 0.0;
  double stiffness = 0.0;
  double damping = 0.0;
  double rotor = 0.0;  ///< kg m²
};

/// On the link.
struct LinkLaw {
  double added_inertia = 0.0;
  double spring = 0.0;
  double rest = 0.0;
  double wall_stiffness = 0.0;
  double wall_damping = 0.0;
  double wall_location = 0.0;
  double wall_side = 1.0;
  double loading = 0.0;        ///< stranger: spring stiffer while it is loaded, by this share
  double loading_width = 1.0;  ///< rad over which it takes over
  double loading_spring = 0.0;
  double loading_rest = 0.0;
  double absorber = 0.0;  ///< stranger: part of the link's inertia that hangs on a spring, kg m²
  double absorber_stiffness = 0.0;
  double absorber_damping = 0.0;
  Wave cross{};  ///< stranger: torque over the angle of another axis
  std::size_t cross_from = 0;
};

struct ReadingLaw {
  double scale = 1.0;
  Wave eccentricity{};  ///< over the drive's angle
  double delay = 0.0;
  double jitter = 0.0;          ///< stranger: s, RMS of the lateness of a stamp under load
  double jitter_from = 0.0;     ///< N m of command on any axis
  double slip_counts = 0.0;     ///< stranger: size of a slip
  std::vector<double> slips{};  ///< when, s
};

struct AxisLaw {
  ActuationLaw actuation{};
  FrictionLaw friction{};
  TransmissionLaw transmission{};
  LinkLaw link{};
  ReadingLaw reading{};
};

/// Everything that moves a concealed device during one run: the rigid body with its loads, and one
/// law an axis.
struct PlantLaw {
  ArmModel::Lumped body{};
  double l1_m = 0.0;
  double l2_m = 0.0;
  JointVector up{0.0, 1.0, 0.0};  ///< against the weight, in base axes
  double hand_stiffness = 0.0;
  double hand_damping = 0.0;
  double time_ratio = 1.0;
  bool logs_current = false;  ///< stranger: the log shows the measured current
  double current_lag = 0.0;
  std::array<AxisLaw, kJoints> axes{};
};

/// @param run_seed decides the instants of catches and slips.
/// @throws ConfigError on an unknown kind or a missing parameter.
[[nodiscard]] PlantLaw plant_law(const ArmModel& arm,
                                 std::span<const Effect> effects,
                                 std::uint64_t run_seed);

}  // namespace teleop::concealed
