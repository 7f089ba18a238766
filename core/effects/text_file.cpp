#include "core/effects/text_file.hpp"

#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {

std::string read_text(const std::filesystem::path& file, const char* what) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw ConfigError{fmt::format("{}: no such {}", file.string(), what)};
  }
  const std::ifstream stream{file};
  if (!stream) throw ConfigError{fmt::format("{}: cannot be read", file.string())};
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace teleop
