#include "core/effects/vocabulary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kVocabulary{
    &actuation_delay,
    &torque_saturation,
    &torque_deadzone,
    &torque_gain,
    &thermal_derating,
    &amplifier_lag,
    &torque_bias,
    &torque_ripple,
    &axis_coupling,
    &viscous_friction,
    &coulomb_friction,
    &stribeck_friction,
    &presliding_hysteresis,
    &lugre_friction,
    &transmission_compliance,
    &backlash,
    &tendon_compliance,
    &cable_spring,
    &payload,
    &base_tilt,
    &added_inertia,
    &encoder_scale,
    &encoder_eccentricity,
    &sensor_delay,
    &quadrature_error,
    &sine_encoder,
    &tool_accelerometer,
    &time_base,
    &joint_contact,
    &hand_impedance,
    &linear_amplifier,
    &pwm_drive,
    &brush_commutation,
    &motor_heat,
};

template <class Named>
std::string names_of(const Named& list) {
  std::vector<std::string_view> names;
  for (const auto& each : list) {
    if constexpr (std::is_pointer_v<std::remove_cvref_t<decltype(each)>>) {
      names.push_back(each->name);
    } else {
      names.push_back(each.name);
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string range_text(const Range& range) {
  if (std::isinf(range.high)) return range.low == 0.0 ? "0 or more" : "more than 0";
  return fmt::format("from {} to {}", range.low, range.high);
}

void check_axis(const EffectSpec& effect, const EffectKind& kind) {
  if (kind.per_axis && !effect.axis) {
    throw ConfigError{fmt::format("{}: axis is missing; allowed: 1, 2, 3", effect.kind)};
  }
  if (!kind.per_axis && effect.axis) {
    throw ConfigError{fmt::format("{}: concerns the whole arm and has no axis", effect.kind)};
  }
  if (effect.axis && *effect.axis >= kJoints) {
    throw ConfigError{
        fmt::format("{}: axis = {}: allowed: 1, 2, 3", effect.kind, *effect.axis + 1)};
  }
}

double value_of(const EffectSpec& effect, const EffectParameter& parameter) {
  const auto found = effect.parameters.find(std::string{parameter.name});
  if (found == effect.parameters.end()) {
    if (parameter.standard) return *parameter.standard;
    throw ConfigError{fmt::format("{}: {} is missing ({}, {})", effect.kind, parameter.name,
                                  parameter.text, parameter.unit)};
  }
  const double value = found->second;
  if (!std::isfinite(value) || value < parameter.range.low || value > parameter.range.high) {
    throw ConfigError{fmt::format("{}: {} = {} {}: must be {}", effect.kind, parameter.name, value,
                                  parameter.unit, range_text(parameter.range))};
  }
  return value;
}

void check_repeated(const EffectKind& kind,
                    const EffectSpec& effect,
                    std::span<const EffectSpec> before) {
  if (kind.repeatable) return;
  for (const EffectSpec& other : before) {
    if (other.kind == effect.kind && other.axis == effect.axis) {
      throw ConfigError{
          fmt::format("{}: twice on the same axis; one of them must go", effect.kind)};
    }
  }
}

}  // namespace

std::span<const EffectKind* const> vocabulary() noexcept { return kVocabulary; }

const EffectKind& find_effect(std::string_view kind) {
  for (const EffectKind* each : kVocabulary) {
    if (each->name == kind) return *each;
  }
  throw ConfigError{
      fmt::format("unknown effect kind '{}'; allowed: {}", kind, names_of(kVocabulary))};
}

void check(const EffectSpec& effect) {
  const EffectKind& kind = find_effect(effect.kind);
  check_axis(effect, kind);
  for (const auto& [name, value] : effect.parameters) {
    const bool known = std::any_of(kind.parameters.begin(), kind.parameters.end(),
                                   [&](const auto& parameter) { return parameter.name == name; });
    if (!known) {
      throw ConfigError{fmt::format("{}: unknown key '{}'; allowed: kind, {}{}", effect.kind, name,
                                    kind.per_axis ? "axis, " : "", names_of(kind.parameters))};
    }
  }
  for (const EffectParameter& parameter : kind.parameters) {
    value_of(effect, parameter);
  }
}

PlantTerms terms_of(std::span<const EffectSpec> effects) {
  PlantTerms terms;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectSpec& effect = effects[i];
    check(effect);
    const EffectKind& kind = find_effect(effect.kind);
    check_repeated(kind, effect, effects.first(i));
    std::vector<double> values;
    for (const EffectParameter& parameter : kind.parameters) {
      values.push_back(value_of(effect, parameter));
    }
    kind.plug(terms, effect.axis.value_or(0), values);
  }
  return terms;
}

}  // namespace teleop
