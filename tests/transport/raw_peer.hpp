#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "transport/codec.hpp"

namespace teleop::testing {

/// The other end of a link under test: a bare socket on loopback, whose every packet is written by
/// the test. Receiving waits two seconds at most.
class RawPeer {
 public:
  explicit RawPeer(int family = AF_INET)
      : family_{family}, socket_{::socket(family, SOCK_DGRAM, 0)} {
    wait_at_most({.tv_sec = 2, .tv_usec = 0});
    sockaddr_storage own = loopback(0);
    is_bound_ = ::bind(socket_, reinterpret_cast<sockaddr*>(&own), size()) == 0;
  }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;
  RawPeer(RawPeer&&) = delete;
  RawPeer& operator=(RawPeer&&) = delete;
  ~RawPeer() { ::close(socket_); }

  /// False where the machine does not have this family.
  [[nodiscard]] bool is_bound() const { return is_bound_; }

  [[nodiscard]] std::uint16_t port() const {
    sockaddr_storage own{};
    socklen_t length = sizeof own;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &length);
    return ntohs(family_ == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&own)->sin6_port
                                     : reinterpret_cast<sockaddr_in*>(&own)->sin_port);
  }

  void send(std::uint16_t to, std::span<const std::byte> bytes) const {
    sockaddr_storage peer = loopback(to);
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&peer), size());
  }
  void send(std::uint16_t to, const Datagram& datagram) const { send(to, encode(datagram)); }

  /// The next packet; nothing when none comes or it is not whole.
  [[nodiscard]] std::optional<Datagram> receive() const {
    std::array<std::byte, 1024> bytes{};
    const ssize_t length = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (length < 0) return std::nullopt;
    const Decoded decoded = decode(std::span{bytes}.first(static_cast<std::size_t>(length)));
    if (decoded.check != Check::ok) return std::nullopt;
    return decoded.datagram;
  }

  /// Lets so much time pass as a slow peer would: on a socket to which nobody sends.
  static void dawdle(Duration time) {
    const RawPeer silent;
    silent.wait_at_most(
        {.tv_sec = 0,
         .tv_usec = std::chrono::duration_cast<std::chrono::microseconds>(time).count()});
    static_cast<void>(silent.receive());
  }

 private:
  void wait_at_most(timeval time) const {
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
  }
  [[nodiscard]] sockaddr_storage loopback(std::uint16_t port) const {
    sockaddr_storage storage{};
    if (family_ == AF_INET6) {
      auto* address = reinterpret_cast<sockaddr_in6*>(&storage);
      address->sin6_family = AF_INET6;
      address->sin6_port = htons(port);
      address->sin6_addr = in6addr_loopback;
    } else {
      auto* address = reinterpret_cast<sockaddr_in*>(&storage);
      address->sin_family = AF_INET;
      address->sin_port = htons(port);
      address->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    return storage;
  }
  [[nodiscard]] socklen_t size() const {
    return family_ == AF_INET6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  }

  int family_;
  int socket_;
  bool is_bound_ = false;
};

}  // namespace teleop::testing
