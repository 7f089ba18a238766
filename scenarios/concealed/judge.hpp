#pragma once

#include <span>

#include "scenarios/concealed/run.hpp"

namespace teleop::concealed {

/// Steady-state Kalman gain of one axis with state [q, q̇, d], d an AR(1) torque:
///
///     q̇⁺ = q̇ + T (u + d + w) / I,   q⁺ = q + T (q̇ + q̇⁺) / 2,   d⁺ = φ d + n,   y = q + e.
struct TetherGain {
  double q = 0.0;
  double v = 0.0;          ///< 1/s
  double d = 0.0;          ///< N m/rad
  double forgotten = 0.0;  ///< φ
};

struct AxisNoise {
  double white_Nm = 0.0;
  double coloured_Nm = 0.0;
  double coloured_time_s = 0.03;
  double reading_rad = 0.0;  ///< RMS, rounding included
};

[[nodiscard]] TetherGain tether_gain(double inertia, const AxisNoise& noise, double period);

/// How visible the effects of a device are: the RMS of the innovations of a plant that is tethered
/// to the recordings by the true noise's Kalman gain, without the effects over with them, less 1;
/// the axis where it is largest. Rigid body and noise are the true ones on both sides.
///
/// @param runs of the device, numbers and recordings; @param substeps of the tethered plants.
struct JudgedRun {
  std::size_t index = 0;
  const Run* run = nullptr;
};
[[nodiscard]] double detectability(const Device& device,
                                   std::span<const JudgedRun> runs,
                                   int substeps);

/// Innovations of one model on one run, RMS an axis, in rad; the first 0.2 s are left out.
/// @param true_model: with the effects and the applied torques; else without, and the logged ones.
[[nodiscard]] JointVector innovations(const Device& device,
                                      const JudgedRun& judged,
                                      bool true_model,
                                      int substeps);

}  // namespace teleop::concealed
