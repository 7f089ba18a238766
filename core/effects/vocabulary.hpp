#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/effects/effect.hpp"
#include "core/effects/plant_terms.hpp"

namespace teleop {

/// Every kind of effect there is. Files, help texts and whatever proposes effects read this list.
[[nodiscard]] std::span<const EffectKind* const> vocabulary() noexcept;

/// @throws ConfigError listing the known kinds.
[[nodiscard]] const EffectKind& find_effect(std::string_view kind);

/// @throws ConfigError naming the effect and the parameter: unknown kind or parameter, one that is
///         missing or out of its range, an axis that is missing, out of 0–2 or not wanted.
void check(const EffectSpec& effect);

/// The effects as terms of the plant's equation.
/// @throws ConfigError as check() does.
[[nodiscard]] PlantTerms terms_of(std::span<const EffectSpec> effects);

}  // namespace teleop
