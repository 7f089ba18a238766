#include "core/program/command_line.hpp"

#include <cstdio>
#include <exception>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/base/version.hpp"

namespace teleop {

std::optional<int> read_command_line(int argc,
                                     const char* const* argv,
                                     const std::string& description,
                                     Settings& settings) {
  CLI::App app{description};
  app.set_version_flag("--version", std::string{kVersion});
  std::vector<std::string> files;
  bool print = false;
  app.add_option("--config", files, "TOML file; several: later ones win")->group("Program");
  app.add_flag("--print-config", print, "print every value with meaning and origin, and leave")
      ->group("Program");
  std::vector<std::string> given(settings.list().size());
  std::vector<CLI::Option*> options;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Setting& setting = settings.list()[i];
    const std::size_t dot = setting.key.find('.');
    options.push_back(app.add_option("--" + setting.key, given[i], setting.text)
                          ->default_str(setting.value())
                          ->type_name("")
                          ->group(dot == std::string::npos ? "What" : setting.key.substr(0, dot)));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    throw ConfigError{fmt::format("{}; --help lists the options", error.what())};
  }
  for (const std::string& file : files) {
    settings.load(file);
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (options[i]->count() > 0) settings.set(settings.list()[i].key, given[i], "command line");
  }
  if (print) {
    std::fputs(settings.print().c_str(), stdout);
    return 0;
  }
  return std::nullopt;
}

int run_program(const std::string& name, int (*body)(int, char**), int argc, char** argv) noexcept {
  try {
    return body(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: failed: %s\n", name.c_str(), error.what());
    return 1;
  }
}

}  // namespace teleop
