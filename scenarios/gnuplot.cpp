#include "scenarios/gnuplot.hpp"

#include <array>
#include <cstdio>
#include <fstream>

#include <fmt/format.h>
#include <sys/wait.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? "'\\''" : std::string{c};
  }
  return result + "'";
}

struct Outcome {
  int status = 0;       ///< exit code; 127: the shell found no such program
  std::string message;  ///< what it printed
};

Outcome run_gnuplot(const fs::path& folder, const std::string& script) {
  const std::string command = "cd " + quoted(fs::absolute(folder).string()) + " && exec gnuplot " +
                              quoted(script) + " 2>&1";
  // NOLINTNEXTLINE(cert-env33-c): the command is ours, its variable parts are quoted
  std::FILE* pipe = popen(command.c_str(), "re");
  if (pipe == nullptr) return {.status = 126, .message = "no process could be started"};
  Outcome outcome;
  std::array<char, 512> block{};
  while (std::fgets(block.data(), static_cast<int>(block.size()), pipe) != nullptr) {
    outcome.message += block.data();
  }
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 126;
  return outcome;
}

}  // namespace

fs::path make_folder(const std::string& name) {
  const fs::path path{name.empty() ? "." : name};
  std::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path, error)) {
    throw ConfigError{fmt::format("{}: not a folder and cannot be made one", path.string())};
  }
  return path;
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out{file, std::ios::binary};
  out << text;
  out.close();
  if (!out) throw ConfigError{fmt::format("{}: cannot be written", file.string())};
}

bool draw_with_gnuplot(const fs::path& folder, const std::string& name, const std::string& script) {
  const std::string file = name + ".gp";
  write_text(folder / file, script);
  const Outcome outcome = run_gnuplot(folder, file);
  if (outcome.status == 0) return true;
  fmt::print(stderr, "{}.png is not drawn: {}\n", name,
             outcome.status == 127
                 ? "gnuplot is not installed: apt-get install gnuplot-nox, then run again"
                 : "gnuplot " + (folder / file).string() + ": " + outcome.message);
  return false;
}

std::string gnuplot_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

}  // namespace teleop
