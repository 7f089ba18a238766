#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace teleop {

/// Writes `value` for scripts, whole or not at all; the folder must exist.
/// @throws ConfigError when it cannot be written.
void write_json(const std::filesystem::path& file, const nlohmann::json& value);

}  // namespace teleop
