#include "core/effects/vocabulary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.hpp"
#include "core/effects/coulomb_friction.hpp"
#include "core/effects/viscous_friction.hpp"

namespace teleop {
namespace {

constexpr std::array kVocabulary{
    &viscous_friction,
    &coulomb_friction,
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
  for (const EffectSpec& effect : effects) {
    check(effect);
    const EffectKind& kind = find_effect(effect.kind);
    std::vector<double> values;
    for (const EffectParameter& parameter : kind.parameters) {
      values.push_back(value_of(effect, parameter));
    }
    kind.plug(terms, effect.axis.value_or(0), values);
  }
  return terms;
}

}  // namespace teleop
