#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "scenarios/child.hpp"
#include "tests/support/command.hpp"
#include "transport/codec.hpp"
#include "transport/crc32c.hpp"

namespace teleop {
namespace {

/// A bare socket on 127.0.0.1.
class Socket {
 public:
  Socket() : handle_{socket(AF_INET, SOCK_DGRAM, 0)} {
    sockaddr_in address = at(0);
    if (bind(handle_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ADD_FAILURE() << "no socket";
    }
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket(Socket&&) = delete;
  Socket& operator=(Socket&&) = delete;
  ~Socket() { close(handle_); }

  [[nodiscard]] int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }

  void send_to(int port, std::span<const std::byte> bytes) const {
    const sockaddr_in address = at(port);
    sendto(handle_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address),
           sizeof address);
  }

 private:
  static sockaddr_in at(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  int handle_;
};

/// A whole packet of another protocol version.
Packet packet_of_version(std::uint16_t version) {
  Packet packet = encode({.session = 7, .sequence = 1});
  constexpr std::size_t kVersionAt = 4;
  std::memcpy(packet.data() + kVersionAt, &version, sizeof version);
  const std::size_t body = packet.size() - sizeof(std::uint32_t);
  const std::uint32_t check = crc32c(std::span{packet}.first(body));
  std::memcpy(packet.data() + body, &check, sizeof check);
  return packet;
}

TEST(Stranger, OfAnotherProtocolVersionIsRefusedWithBothVersions) {
  Child slave{
      "slave",
      {sibling_program("teleop-slave"), "--status_json", "true", "--link.bind", "127.0.0.1:0"}};
  const auto line = slave.next_line(5000);
  ASSERT_TRUE(line.has_value());
  const std::string address = nlohmann::json::parse(*line).at("address").get<std::string>();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));

  const Socket socket;
  for (int i = 0; i < 100 && !slave.exit_code(); ++i) {
    socket.send_to(port, packet_of_version(99));
    (void)slave.next_line(200);
  }

  EXPECT_EQ(slave.end(2000), 2);
}

TEST(Stranger, OnTheOwnPortIsNamedAndTheExitCodeIs2) {
  const Socket socket;
  const std::string address = "127.0.0.1:" + std::to_string(socket.port());

  const testing::Finished finished = testing::run("teleop-slave --link.bind " + address);

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.output.find(address), std::string::npos) << finished.output;
}

}  // namespace
}  // namespace teleop
