#pragma once

#include <string>
#include <string_view>

namespace teleop {

/// Where a socket is: a name or number, and a port.
struct Address {
  std::string host;  ///< without brackets
  std::string port;  ///< 0–65535
};

/// Reads "host:port", "10.0.0.2:5000" or "[::1]:5000".
/// @throws TransportError naming `key`, the configuration value that the text comes from.
[[nodiscard]] Address parse_address(std::string_view text, std::string_view key);

}  // namespace teleop
