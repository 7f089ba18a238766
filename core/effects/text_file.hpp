#pragma once

#include <filesystem>
#include <string>

namespace teleop {

/// A whole text file.
/// @throws ConfigError when there is none or it cannot be read; `what` says what it should be.
[[nodiscard]] std::string read_text(const std::filesystem::path& file, const char* what);

}  // namespace teleop
