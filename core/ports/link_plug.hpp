#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/settings.hpp"
#include "core/ports/link.hpp"

namespace teleop {

/// How a program gets its link without knowing any transport. Used before the loop only.
struct LinkPlug {
  struct Opened {
    std::unique_ptr<Link> link;
    std::string address;               ///< "127.0.0.1:47001": where the peer finds this side
    std::vector<std::string> refused;  ///< what the system refused to its threads
  };
  std::function<void(Settings&)> add_settings;  ///< adds the link's own keys
  std::function<Opened()> open;                 ///< @throws TransportError
  std::uint32_t protocol_version = 0;
};

}  // namespace teleop
