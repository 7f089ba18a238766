#include "scenarios/concealed/effect.hpp"

#include <algorithm>
#include <array>

#include "core/base/error.hpp"

namespace teleop::concealed {
namespace {

constexpr std::array<Kind, 25> kVocabulary{{
    {"actuation_delay", "actuation"},
    {"torque_saturation", "actuation"},
    {"torque_deadzone", "actuation"},
    {"torque_gain", "actuation"},
    {"thermal_derating", "actuation"},
    {"amplifier_lag", "actuation"},
    {"torque_bias", "actuation"},
    {"torque_ripple", "actuation"},
    {"axis_coupling", "actuation"},
    {"viscous_friction", "joint"},
    {"coulomb_friction", "joint"},
    {"stribeck_friction", "joint"},
    {"presliding_hysteresis", "joint"},
    {"backlash", "joint"},
    {"transmission_compliance", "joint"},
    {"cable_spring", "joint"},
    {"payload", "load", false},
    {"base_tilt", "load", false},
    {"added_inertia", "load"},
    {"encoder_scale", "sensing"},
    {"encoder_eccentricity", "sensing"},
    {"sensor_delay", "sensing"},
    {"time_base", "timing", false},
    {"contact", "environment"},
    {"hand_impedance", "environment", false},
}};

constexpr std::array<Kind, 13> kStrangers{{
    {"oov_growing_friction", "unknown"},
    {"oov_local_friction", "unknown"},
    {"oov_one_way_friction", "unknown"},
    {"oov_catch", "unknown"},
    {"oov_cross_coupling", "unknown"},
    {"oov_quadratic_drag", "unknown"},
    {"oov_hysteretic_spring", "unknown"},
    {"oov_command_rate_loss", "unknown"},
    {"oov_varying_gain", "unknown"},
    {"oov_link_resonance", "unknown"},
    {"oov_encoder_slips", "unknown"},
    {"oov_jitter_under_load", "unknown", false},
    {"oov_logged_current", "unknown", false},
}};

}  // namespace

double Effect::at(std::string_view name) const {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& each) { return each.first == name; });
  if (found == parameters.end()) {
    throw ConfigError{"effect " + kind + " has no parameter " + std::string{name} +
                      ": give it as the format defines it"};
  }
  return found->second;
}

double& Effect::at(std::string_view name) {
  const Effect& self = *this;
  static_cast<void>(self.at(name));
  return std::find_if(parameters.begin(), parameters.end(),
                      [&](const auto& each) { return each.first == name; })
      ->second;
}

std::span<const Kind> vocabulary() noexcept { return kVocabulary; }

std::span<const Kind> strangers() noexcept { return kStrangers; }

const Kind& find_kind(std::string_view name) {
  for (const std::span<const Kind> kinds : {vocabulary(), strangers()}) {
    for (const Kind& kind : kinds) {
      if (kind.name == name) return kind;
    }
  }
  throw ConfigError{"no effect is called " + std::string{name} + ": see the answer format"};
}

}  // namespace teleop::concealed
