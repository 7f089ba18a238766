#pragma once

#include <filesystem>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace teleop {

/// Writes `value` for scripts, whole or not at all; the folder must exist.
/// @throws ConfigError when it cannot be written.
void write_json(const std::filesystem::path& file, const nlohmann::json& value);

/// The same for text.
void write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace teleop
