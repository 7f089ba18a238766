#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/settings.hpp"
#include "core/ports/link.hpp"
#include "core/realtime/scheduling.hpp"
#include "transport/session.hpp"

namespace teleop {

/// The link over UDP, IPv4 or IPv6. The packet is in docs/wire.md.
///
/// A thread of its own waits for packets, stamps their arrival on the monotonic clock, checks them
/// and leaves the newest state in a mailbox; the loop takes it from there and is never woken.
///
/// With `peer` given only that address is heard. Without, the first valid sender is answered, and
/// the address changes when another session replaces a silent one (see Receiver).
///
/// Thread: the loop's only, but for its own receiving one.
/// Loop: receive, send and statistics neither allocate, block nor throw; a packet that the system
/// does not take at once is dropped and counted in unsent().
class UdpLink final : public Link {
 public:
  struct Config {
    std::string bind = "127.0.0.1:0";   ///< port 0: the system picks one
    std::string peer{};                 ///< empty: whoever speaks first
    bool own_thread = true;             ///< false: the caller receives in wait()
    Realtime realtime{.priority = 81};  ///< of the receiving thread: above the loop, so that
                                        ///< arrivals are stamped on time
  };

  /// Opens the socket and starts the thread.
  /// @throws TransportError: bad address text, unknown host, port taken, no such own address.
  explicit UdpLink(const Config& config);
  UdpLink(const UdpLink&) = delete;
  UdpLink& operator=(const UdpLink&) = delete;
  UdpLink(UdpLink&&) = delete;
  UdpLink& operator=(UdpLink&&) = delete;
  ~UdpLink() override;

  [[nodiscard]] std::optional<PeerSample> receive() noexcept override;

  /// Sends nothing while there is no peer to send to.
  void send(const PeerState& state) noexcept override;

  /// As of the last receive() or send().
  [[nodiscard]] LinkStatistics statistics() const noexcept override;

  /// Receives in the caller's thread: blocks until a packet has been taken in, valid or not.
  /// @pre own_thread is false.
  /// @returns false when none came within kWait.
  bool wait() noexcept;
  static constexpr std::chrono::microseconds kWait{50'000};

  [[nodiscard]] std::uint16_t port() const;  ///< bound to
  [[nodiscard]] std::uint64_t session() const noexcept override { return session_; }
  [[nodiscard]] std::uint64_t unsent() const noexcept { return unsent_; }

  /// What the system refused to the receiving thread; empty when all was granted.
  [[nodiscard]] const std::vector<std::string>& refused() const noexcept { return refused_; }

 private:
  struct Inbox;
  class Socket;

  void look() noexcept;

  std::uint64_t session_;
  Sender sender_;
  std::uint64_t sent_ = 0;
  std::uint64_t unsent_ = 0;
  std::uint64_t returned_ = 0;  // deliveries seen by receive()
  std::unique_ptr<Inbox> inbox_;
  std::unique_ptr<Socket> socket_;
  std::vector<std::string> refused_;
};

void add_settings(Settings& settings, const std::string& prefix, UdpLink::Config& config);

}  // namespace teleop
