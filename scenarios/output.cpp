#include "scenarios/output.hpp"

#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"

namespace teleop {

void write_text(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path draft = file.string() + ".part";
  std::ofstream out{draft};
  out << text;
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(draft, file, error);
  if (!out || error) throw ConfigError{fmt::format("{}: cannot be written", file.string())};
}

void write_json(const std::filesystem::path& file, const nlohmann::json& value) {
  write_text(file, value.dump(2) + '\n');
}

}  // namespace teleop
