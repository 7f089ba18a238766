#include "transport/plug.hpp"

#include "transport/codec.hpp"

namespace teleop {

LinkPlug udp_plug(UdpLink::Config& config) {
  return {
      .add_settings = [&config](Settings& settings) { add_settings(settings, "link.", config); },
      .open =
          [&config] {
            auto link = std::make_unique<UdpLink>(config);
            const std::string host = config.bind.substr(0, config.bind.rfind(':'));
            std::string address = host + ':' + std::to_string(link->port());
            std::vector<std::string> refused;
            for (const std::string& line : link->refused()) {
              refused.push_back("receiving thread: " + line);
            }
            return LinkPlug::Opened{.link = std::move(link),
                                    .address = std::move(address),
                                    .refused = std::move(refused)};
          },
      .protocol_version = kProtocolVersion,
  };
}

}  // namespace teleop
