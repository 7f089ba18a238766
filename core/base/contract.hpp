#pragma once

#include <source_location>

namespace teleop {

/// Stops the program because it is wrong: prints file, line and `what`, then aborts, so that the
/// device's own watchdog makes the hardware safe. For defects of the program, never for bad input.
[[noreturn]] void contract_broken(const char* what, const std::source_location& where) noexcept;

/// Always on, in release builds too.
inline void expects(bool condition,
                    const char* what,
                    const std::source_location& where = std::source_location::current()) noexcept {
  if (!condition) contract_broken(what, where);
}

}  // namespace teleop
