#pragma once

#include "core/effects/plant_terms.hpp"

namespace teleop {

/// Gains that hold one axis to its readings where the drive does not move as its link does: the
/// steady Kalman filter of drive, link and disturbance, with the readings at the drive.
struct DriveGains {
  double m = 0.0;   ///< rad per rad of innovation
  double md = 0.0;  ///< rad/s per rad
  double q = 0.0;
  double qd = 0.0;
  double d = 0.0;          ///< N m per rad
  double deviation = 0.0;  ///< of the innovations, rad
};

/// Noise of one axis.
struct AxisNoise {
  double white = 0.0;     ///< N m
  double coloured = 0.0;  ///< N m
  double memory = 0.0;    ///< φ
  double reading = 0.0;   ///< rad
};

/// Of an elastic transmission. @param link_inertia of the link without the drive, kg m²
[[nodiscard]] DriveGains elastic_gains(const Transmission& transmission,
                                       double link_inertia,
                                       double period_s,
                                       const AxisNoise& noise);

/// Of a drive within its play: the link is not seen.
[[nodiscard]] DriveGains free_gains(const Transmission& transmission,
                                    double period_s,
                                    const AxisNoise& noise);

}  // namespace teleop
