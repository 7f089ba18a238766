#pragma once

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "scenarios/scoring/case_truth.hpp"

namespace teleop {

/// Which parameter of a kind is held against the truth, and by what its error is measured: the true
/// value, its departure from a nominal one, or a fixed length.
struct GradedParameter {
  std::string_view name{};
  double nominal = 0.0;
  double fixed = 0.0;  ///< 0: none
};

struct KindRule {
  std::string_view kind{};
  std::vector<GradedParameter> graded{};
  bool vector = false;  ///< graded parameters are components, measured by their common length
};

/// Nothing for a kind that the vocabulary does not have.
[[nodiscard]] const KindRule* find_rule(std::string_view kind);

/// The channel of a kind of the vocabulary.
[[nodiscard]] std::string_view channel_of(std::string_view kind);

/// Kind and axis as they are compared: no axis where the kind has none.
[[nodiscard]] EffectName name_as_compared(EffectName name);

/// A constant torque beside Coulomb friction or a cable spring on one axis is part of that effect.
template <class Effects>
void drop_absorbed(Effects& effects) {
  const Effects all = effects;
  std::erase_if(effects, [&all](const auto& each) {
    return each.name.kind == "torque_bias" &&
           std::any_of(all.begin(), all.end(), [&each](const auto& other) {
             return other.name.axis == each.name.axis &&
                    (other.name.kind == "coulomb_friction" || other.name.kind == "cable_spring");
           });
  });
}

}  // namespace teleop
