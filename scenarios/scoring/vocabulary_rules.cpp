#include "scenarios/scoring/vocabulary_rules.hpp"

#include "core/base/contract.hpp"
#include "scenarios/concealed/effect.hpp"

namespace teleop {
namespace {

const std::vector<KindRule>& rules() {
  static const std::vector<KindRule> list{
      {"torque_gain", {{"gain", 1.0}}},
      {"torque_bias", {{"bias"}}},
      {"torque_saturation", {{"limit"}}},
      {"torque_deadzone", {{"threshold"}}},
      {"torque_ripple", {{"amplitude"}, {"period"}}},
      {"amplifier_lag", {{"time_constant"}}},
      {"actuation_delay", {{"delay"}}},
      {"thermal_derating", {{"loss"}, {"time_constant"}}},
      {"axis_coupling", {{"fraction"}}},
      {"viscous_friction", {{"coefficient"}}},
      {"coulomb_friction", {{"level"}}},
      {"stribeck_friction", {{"coulomb"}, {"static"}, {"stribeck_velocity"}}},
      {"presliding_hysteresis", {{"level"}, {"stiffness"}}},
      {"backlash", {{"gap"}}},
      {"transmission_compliance", {{"stiffness"}}},
      {"cable_spring", {{"stiffness"}}},
      {"payload", {{"mass"}}},
      {"base_tilt", {{"tilt_x"}, {"tilt_z"}}, true},
      {"added_inertia", {{"inertia"}}},
      {"encoder_scale", {{"scale", 1.0}}},
      {"encoder_eccentricity", {{"amplitude"}}},
      {"sensor_delay", {{"delay"}}},
      {"time_base", {{"ratio", 1.0}}},
      {"contact", {{.name = "location", .fixed = 0.1}, {"stiffness"}}},
      {"hand_impedance", {{"stiffness"}, {"damping"}, {"mass"}}},
  };
  return list;
}

}  // namespace

const KindRule* find_rule(std::string_view kind) {
  const auto found = std::find_if(rules().begin(), rules().end(),
                                  [kind](const KindRule& each) { return each.kind == kind; });
  return found == rules().end() ? nullptr : &*found;
}

std::string_view channel_of(std::string_view kind) {
  expects(find_rule(kind) != nullptr, "a kind of the vocabulary");
  return concealed::find_kind(kind).channel;
}

EffectName name_as_compared(EffectName name) {
  if (find_rule(name.kind) != nullptr && !concealed::find_kind(name.kind).per_axis) {
    name.axis.reset();
  }
  return name;
}

}  // namespace teleop
