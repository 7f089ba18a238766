#include "transport/address.hpp"

#include <charconv>
#include <cstdint>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

bool is_port(std::string_view text) {
  std::uint16_t port = 0;
  const std::string digits{text};
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, port);
  return error == std::errc{} && stop == end;
}

}  // namespace

Address parse_address(std::string_view text, std::string_view key) {
  const auto refuse = [&](std::string_view reason) {
    return TransportError{fmt::format(
        "{} = \"{}\": {}; write host:port, 10.0.0.2:5000 or [::1]:5000", key, text, reason)};
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) throw refuse("no port");
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (!is_port(port)) throw refuse("the port is not a number from 0 to 65535");
  if (host.starts_with('[')) {
    if (!host.ends_with(']')) throw refuse("a bracket is not closed");
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    throw refuse("an IPv6 address stands in brackets");
  }
  if (host.empty()) throw refuse("no host");
  return {.host = std::string{host}, .port = std::string{port}};
}

}  // namespace teleop
