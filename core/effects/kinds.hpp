#pragma once

#include "core/effects/effect.hpp"

namespace teleop {

/// The kinds of effects, a file each; vocabulary.cpp lists them. Laws as in EffectKind::law, with q
/// the link's angle, m the drive's (the same where nothing gives way between them), u the commanded
/// and a the delivered torque of an axis, y its reading. Friction acts on the drive's side.

/// A command acts later, by whole and broken samples alike.
extern const EffectKind actuation_delay;

/// The amplifier gives no more than its limit.
extern const EffectKind torque_saturation;

/// Small commands are lost and large ones shortened by as much.
extern const EffectKind torque_deadzone;

/// The torque constant is not the one that was believed.
extern const EffectKind torque_gain;

/// Torque that is lost as the motor warms up.
extern const EffectKind thermal_derating;

/// An amplifier of first order.
extern const EffectKind amplifier_lag;

/// A torque that is always there.
extern const EffectKind torque_bias;

/// Cogging: a torque over the angle that no command asks for.
extern const EffectKind torque_ripple;

/// A share of another axis's command acts here too.
extern const EffectKind axis_coupling;

/// Friction in proportion to speed.
extern const EffectKind viscous_friction;

/// Dry friction: a joint at rest stays at rest, exactly, until more than the level asks it to move.
extern const EffectKind coulomb_friction;

/// Dry friction that is larger at rest than in motion.
extern const EffectKind stribeck_friction;

/// Friction that bends before it slips, after Dahl.
extern const EffectKind presliding_hysteresis;

/// Bristles that bend, slip and slip easier when fast, after Canudas de Wit and others.
extern const EffectKind lugre_friction;

/// Cable and link as spring and damper between two masses; form (a) of the transfer functions.
extern const EffectKind transmission_compliance;

/// Free play between drive and link; it closes without a rebound.
extern const EffectKind backlash;

/// The tendon that carries the motor's reaction to ground gives way under it; form (b) of the
/// transfer functions.
extern const EffectKind tendon_compliance;

/// A cable that pulls the link to one place.
extern const EffectKind cable_spring;

/// A point mass at the tool, with its weight.
extern const EffectKind payload;

/// The base does not stand upright.
extern const EffectKind base_tilt;

/// More inertia in one joint.
extern const EffectKind added_inertia;

/// The encoder's counts a turn are not the ones that were believed.
extern const EffectKind encoder_scale;

/// The code wheel sits off centre.
extern const EffectKind encoder_eccentricity;

/// The angle is read late, by whole and broken samples alike.
extern const EffectKind sensor_delay;

/// The four edges of an encoder line are not evenly spaced.
extern const EffectKind quadrature_error;

/// A sine encoder in place of the square one: each line is divided finer.
extern const EffectKind sine_encoder;

/// An accelerometer at the tool.
extern const EffectKind tool_accelerometer;

/// The sampling clock runs at another rate than stated.
extern const EffectKind time_base;

/// A one-sided wall in one joint.
extern const EffectKind joint_contact;

/// A hand that holds the tool at one place.
extern const EffectKind hand_impedance;

/// A linear current amplifier: what the paper put in place of the stock drive.
extern const EffectKind linear_amplifier;

/// The stock drive: a voltage that is switched on for a share of each carrier period.
extern const EffectKind pwm_drive;

/// The winding's resistance changes as the brushes pass from segment to segment; a voltage drive
/// makes cogging of it.
extern const EffectKind brush_commutation;

/// A motor of two nodes, winding and housing, that warms up.
extern const EffectKind motor_heat;

/// Inertia of motor and pulley as seen from the joint, kg m^2: what a transmission moves from the
/// link to the drive unless told otherwise. About the rotor that the paper's inertias contain.
[[nodiscard]] constexpr double rotor_inertia(std::size_t axis) noexcept {
  return axis == 0 ? 1.8e-4 : 1.25e-4;
}

}  // namespace teleop
