#pragma once

#include <algorithm>
#include <cmath>

#include "core/effects/plant_terms.hpp"

namespace teleop {

/// The bristle of JointFriction along a stretch of motion in one direction s = ±1, over which its
/// law is solved by displacement instead of time,
///
///     z = s g + (z_0 − s g) exp(−s stiffness (m − m_0) / g),
///
/// exactly for Dahl's law, where g is constant; with g at the mean of the speeds at its ends
/// otherwise. Loop: allocation-free, noexcept.

/// g(v), N m.
[[nodiscard]] inline double slip_level(const JointFriction::Bristle& bristle, double v) noexcept {
  if (bristle.static_level == bristle.level) return bristle.level;
  const double x = v / bristle.stribeck_velocity;
  return bristle.level + (bristle.static_level - bristle.level) * std::exp(-x * x);
}

/// z after a displacement of `turn`, N m.
[[nodiscard]] inline double bend(const JointFriction::Bristle& bristle,
                                 double z,
                                 double turn,
                                 double v,
                                 double direction) noexcept {
  const double g = slip_level(bristle, v);
  const double limit = direction * g;
  // A trial step may turn back a little; its end is thrown away, but it must stay finite.
  const double decay = std::max(direction * bristle.stiffness * turn / g, -1.0);
  return limit + (z - limit) * std::exp(-decay);
}

/// Torque of the bristle on the drive, N m.
[[nodiscard]] inline double bristle_torque(const JointFriction::Bristle& bristle,
                                           double z,
                                           double v,
                                           double direction) noexcept {
  double torque = -z;
  if (bristle.micro_damping > 0.0) {
    torque -= bristle.micro_damping * v * (1.0 - direction * z / slip_level(bristle, v));
  }
  return torque;
}

}  // namespace teleop
