#pragma once

#include "core/ports/link_plug.hpp"
#include "transport/udp_link.hpp"

namespace teleop {

/// The UDP link for a program; its settings stand under "link.". `config` holds the defaults, is
/// filled by the settings and must outlive the plug.
[[nodiscard]] LinkPlug udp_plug(UdpLink::Config& config);

}  // namespace teleop
