#pragma once

#include <optional>
#include <string>

#include "core/base/settings.hpp"

namespace teleop {

/// Reads the command line of a program whose whole configuration is a list of settings: `--config
/// FILE` (several: later ones win), one `--key VALUE` a setting, `--print-config`, `--help`,
/// `--version`. The command line wins over files, files over defaults.
///
/// @returns the exit code when the program is done already (help printed, configuration printed),
///          nothing when it should go on.
/// @throws ConfigError on a bad command line, file or value.
[[nodiscard]] std::optional<int> read_command_line(int argc,
                                                   const char* const* argv,
                                                   const std::string& description,
                                                   Settings& settings);

/// Runs a program's body and turns its exceptions into the house's exit codes: bad input is one
/// line on stderr and 2, anything unforeseen 1.
[[nodiscard]] int run_program(const std::string& name,
                              int (*body)(int, char**),
                              int argc,
                              char** argv) noexcept;

}  // namespace teleop
