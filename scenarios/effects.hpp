#pragma once

#include <string>

namespace teleop {

struct EffectsOptions {
  std::string kind;       ///< only this one; empty: all
  bool markdown = false;  ///< as docs/effects.md has it
  std::string json;       ///< file for the vocabulary; empty: none
};

/// The vocabulary as tables of Markdown, a kind a table.
[[nodiscard]] std::string effects_as_markdown();

/// `teleop effects`: every kind of effect with its law, parameters, units and ranges.
/// @returns the exit code.
/// @throws ConfigError when there is no such kind or the file cannot be written.
[[nodiscard]] int run_effects(const EffectsOptions& options);

}  // namespace teleop
