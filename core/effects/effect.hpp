#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/settings.hpp"
#include "core/effects/plant_terms.hpp"

namespace teleop {

/// One parameter of an effect: its key in files, what it may be and what it means.
struct EffectParameter {
  std::string_view name{};
  std::string_view unit{};
  std::string_view text{};
  Range range{};
  std::optional<double> standard{};  ///< taken when a file leaves it out; none: it must be given
};

/// One effect as somebody asks for it: a [[effect]] table of a plant file.
struct EffectSpec {
  std::string kind{};
  std::optional<std::size_t>
      axis{};  ///< 0 to 2; none for an effect of the whole arm. 1 to 3 in files
  std::map<std::string, double> parameters{};

  [[nodiscard]] bool operator==(const EffectSpec&) const = default;
};

/// One kind of physical effect: its name, its parameters and what it adds to the plant. Each kind
/// is one file that defines one constant of this type; kinds.hpp and vocabulary.cpp list them.
struct EffectKind {
  std::string_view name{};
  std::string_view law{};  ///< in text mathematics
  bool per_axis = true;
  bool repeatable = false;  ///< several on one axis add up; else the second one is refused
  std::span<const EffectParameter> parameters{};

  /// Adds the effect to the terms; `values` are in the order of `parameters` and in their ranges.
  /// @throws ConfigError when they do not fit each other or what is there already.
  void (*plug)(PlantTerms& terms, std::size_t axis, std::span<const double> values) = nullptr;
};

}  // namespace teleop
