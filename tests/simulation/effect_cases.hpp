#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/effects/effect.hpp"

namespace teleop::testing {

/// Where an effect's signature may appear and where it must not.
enum class Channel { actuation, joint, whole_arm, sensing, timing };

struct EffectCase {
  EffectSpec effect{};
  Channel channel = Channel::joint;
  bool passive = false;  ///< adds no energy whatever the motion
};

/// One of every kind at a size that shows, per-axis ones on the given axis.
inline std::vector<EffectCase> effect_cases(std::size_t axis) {
  using P = std::map<std::string, double>;
  const auto on_axis = [&](const char* kind, P p, Channel channel, bool passive = false) {
    return EffectCase{{.kind = kind, .axis = axis, .parameters = std::move(p)}, channel, passive};
  };
  const auto whole = [&](const char* kind, P p, Channel channel, bool passive = false) {
    return EffectCase{
        {.kind = kind, .axis = std::nullopt, .parameters = std::move(p)}, channel, passive};
  };
  using enum Channel;
  return {
      on_axis("actuation_delay", {{"delay", 0.0023}}, actuation),
      on_axis("torque_saturation", {{"limit", 0.02}}, actuation),
      on_axis("torque_deadzone", {{"threshold", 0.004}}, actuation),
      on_axis("torque_gain", {{"gain", 0.9}}, actuation),
      on_axis("thermal_derating", {{"loss", 0.2}, {"time_constant", 0.3}}, actuation),
      on_axis("amplifier_lag", {{"time_constant", 0.0013}}, actuation),
      on_axis("torque_bias", {{"bias", 0.003}}, actuation),
      on_axis("torque_ripple", {{"amplitude", 0.003}, {"period", 0.1}, {"phase", 0.4}}, actuation),
      on_axis("axis_coupling",
              {{"fraction", 0.1}, {"from_axis", static_cast<double>(1 + (axis + 1) % 3)}},
              actuation),
      on_axis("viscous_friction", {{"coefficient", 0.01}, {"asymmetry", 0.3}}, joint, true),
      on_axis("coulomb_friction", {{"level", 0.006}, {"asymmetry", -0.2}}, joint, true),
      on_axis("stribeck_friction",
              {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.05}}, joint, true),
      on_axis("presliding_hysteresis", {{"level", 0.006}, {"stiffness", 3.0}}, joint, true),
      on_axis("lugre_friction",
              {{"coulomb", 0.004},
               {"static", 0.006},
               {"stribeck_velocity", 0.1},
               {"stiffness", 5.0},
               {"micro_damping", 0.002}},
              joint, true),
      on_axis("transmission_compliance", {{"stiffness", 40.0}, {"damping", 0.01}}, joint, true),
      on_axis("backlash", {{"gap", 0.004}}, joint, true),
      on_axis("cable_spring", {{"stiffness", 0.05}, {"rest_angle", 0.1}}, joint, true),
      on_axis("added_inertia", {{"inertia", 2e-4}}, joint, true),
      on_axis("contact", {{"location", 0.05}, {"stiffness", 20.0}, {"damping", 0.05}, {"side", 1}},
              joint, true),
      whole("payload", {{"mass", 0.02}}, whole_arm, true),
      whole("base_tilt", {{"tilt_x", 0.2}, {"tilt_z", -0.1}}, whole_arm, true),
      whole("hand_impedance", {{"stiffness", 100.0}, {"damping", 2.0}, {"mass", 0.03}}, whole_arm,
            true),
      on_axis("tendon_compliance", {{"stiffness", 60.0}}, sensing),
      on_axis("encoder_scale", {{"scale", 1.02}}, sensing),
      on_axis("encoder_eccentricity",
              {{"amplitude", 0.002}, {"phase", 0.3}, {"cycles_per_joint_rev", 11.2}}, sensing),
      on_axis("sensor_delay", {{"delay", 0.0017}}, sensing),
      on_axis("quadrature_error", {{"phase_error", 0.3}, {"duty_error", -0.2}}, sensing),
      on_axis("sine_encoder", {{"steps_per_line", 64.0}, {"error", 0.01}}, sensing),
      whole("tool_accelerometer", {{"noise", 0.05}}, sensing),
      whole("time_base", {{"ratio", 1.01}}, timing),
      on_axis("linear_amplifier",
              {{"bandwidth_Hz", 800.0}, {"current_limit_A", 3.0}, {"voltage_limit_V", 24.0}},
              actuation),
      on_axis("pwm_drive", {{"supply_V", 12.0}, {"carrier_Hz", 20e3}}, actuation),
      on_axis("brush_commutation", {{"depth", 0.2}, {"period", 0.05}}, actuation),
      on_axis("motor_heat",
              {{"winding_to_housing_K_per_W", 3.1},
               {"housing_to_ambient_K_per_W", 12.0},
               {"winding_J_per_K", 0.01},
               {"housing_J_per_K", 0.1},
               {"magnet_per_K", 0.01}},
              actuation),
  };
}

}  // namespace teleop::testing
