#include "transport/udp_link.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <future>
#include <random>
#include <thread>

#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <asio/ip/v6_only.hpp>
#include <fmt/format.h>
#include <sys/socket.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"
#include "core/realtime/mailbox.hpp"
#include "transport/address.hpp"

namespace teleop {
namespace {

using Udp = asio::ip::udp;

Instant now() noexcept { return std::chrono::steady_clock::now(); }

std::uint64_t draw_session() {
  std::random_device device;
  const std::uint64_t session = (std::uint64_t{device()} << 32U) | device();
  return session == 0 ? 1 : session;
}

Udp::resolver::results_type resolve(asio::io_context& context,
                                    const std::string& text,
                                    const char* key) {
  const Address address = parse_address(text, key);
  asio::error_code error;
  const auto found = Udp::resolver{context}.resolve(address.host, address.port, error);
  if (error) {
    throw TransportError{fmt::format("{} = \"{}\": {}; check the name or give a number", key, text,
                                     error.message())};
  }
  return found;
}

const char* advice_for(const asio::error_code& error) noexcept {
  if (error == asio::error::address_in_use) {
    return "end the program that has it or take another port, 0 picks a free one";
  }
  if (error == asio::error::access_denied) return "take a port from 1024 on";
  return "give an address of this machine, 0.0.0.0 or [::] for all of them";
}

Udp::socket open_socket(asio::io_context& context, const std::string& bind) {
  const Udp::endpoint own = resolve(context, bind, "link.bind").begin()->endpoint();
  Udp::socket socket{context};
  asio::error_code error;
  socket.open(own.protocol(), error);
  // Which peers can be heard must not depend on the system's settings.
  if (!error && own.protocol() == Udp::v6()) socket.set_option(asio::ip::v6_only{true}, error);
  if (!error) socket.bind(own, error);
  const timeval timeout{.tv_sec = 0, .tv_usec = UdpLink::kWait.count()};
  if (!error && ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &timeout,
                             sizeof timeout) != 0) {
    error.assign(errno, asio::error::get_system_category());
  }
  if (error) {
    throw TransportError{
        fmt::format("link.bind = \"{}\": {}; {}", bind, error.message(), advice_for(error))};
  }
  return socket;
}

std::optional<Udp::endpoint> find_peer(asio::io_context& context,
                                       const UdpLink::Config& config,
                                       const Udp& protocol) {
  if (config.peer.empty()) return std::nullopt;
  for (const auto& entry : resolve(context, config.peer, "link.peer")) {
    if (entry.endpoint().port() == 0) {
      throw TransportError{fmt::format(
          "link.peer = \"{}\": port 0; give the port that the peer is bound to", config.peer)};
    }
    if (entry.endpoint().protocol() == protocol) return entry.endpoint();
  }
  throw TransportError{
      fmt::format("link.peer = \"{}\": not reachable from link.bind = \"{}\"; "
                  "both must be IPv4 or both IPv6",
                  config.peer, config.bind)};
}

}  // namespace

/// What the receiving side tells the loop.
struct UdpLink::Inbox {
  PeerSample sample{};
  std::uint64_t deliveries = 0;  ///< counts samples
  std::optional<Heard> heard;
  std::optional<Udp::endpoint> peer;
  LinkStatistics statistics{};
};

/// The socket and everything that happens on its receiving side.
class UdpLink::Socket {
 public:
  Socket(const Config& config, std::uint64_t session)
      : socket_{open_socket(context_, config.bind)},
        fixed_peer_{!config.peer.empty()},
        receiver_{session} {
    inbox_.peer = find_peer(context_, config, socket_.local_endpoint().protocol());
    mailbox_.put(inbox_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket(Socket&&) = delete;
  Socket& operator=(Socket&&) = delete;

  ~Socket() {
    if (!thread_.joinable()) return;
    stopping_.store(true, std::memory_order_relaxed);
    // Wakes the thread; where it does not, the timeout of the socket does.
    ::shutdown(socket_.native_handle(), SHUT_RDWR);
    thread_.join();
  }

  /// @returns what the system refused to the thread.
  std::vector<std::string> start(const Realtime& realtime) {
    std::promise<std::vector<std::string>> prepared;
    std::future<std::vector<std::string>> refused = prepared.get_future();
    thread_ = std::thread{[this, realtime, prepared = std::move(prepared)]() mutable {
      sigset_t all;
      sigfillset(&all);
      pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are for the program's other threads
      prepared.set_value(realtime.enabled ? prepare_thread(realtime) : std::vector<std::string>{});
      while (!stopping_.load(std::memory_order_relaxed)) {
        receive_one();
      }
    }};
    return refused.get();
  }

  /// Asio's own receive cannot time out, so this is the system call.
  bool receive_one() noexcept {
    std::array<std::byte, 2 * kPacketSize> buffer;  // NOLINT: filled by the system
    Udp::endpoint from;
    auto from_size = static_cast<socklen_t>(from.capacity());
    const ssize_t size = ::recvfrom(socket_.native_handle(), buffer.data(), buffer.size(), 0,
                                    from.data(), &from_size);
    const Instant arrival = now();
    if (size < 0) return false;
    from.resize(from_size);
    take_in(std::span{buffer}.first(static_cast<std::size_t>(size)), from, arrival);
    return true;
  }

  /// Asio's own send would wait for room, so this is the system call.
  bool send(const Packet& packet, const Udp::endpoint& to) noexcept {
    return ::sendto(socket_.native_handle(), packet.data(), packet.size(), MSG_DONTWAIT, to.data(),
                    static_cast<socklen_t>(to.size())) == static_cast<ssize_t>(packet.size());
  }

  bool look(Inbox& inbox) noexcept { return mailbox_.take(inbox); }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  [[nodiscard]] bool has_thread() const noexcept { return thread_.joinable(); }

 private:
  void take_in(std::span<const std::byte> bytes,
               const Udp::endpoint& from,
               Instant arrival) noexcept {
    const Decoded decoded = decode(bytes);
    if (decoded.check != Check::ok || !is_peer(from, decoded.datagram.session, arrival)) {
      receiver_.refuse(decoded);
    } else if (const auto sample = receiver_.step(decoded.datagram, arrival)) {
      inbox_.sample = *sample;
      ++inbox_.deliveries;
      inbox_.heard = receiver_.heard();
      inbox_.peer = from;
    }
    inbox_.statistics = receiver_.statistics();
    mailbox_.put(inbox_);
  }

  [[nodiscard]] bool is_peer(const Udp::endpoint& from,
                             std::uint64_t session,
                             Instant arrival) const noexcept {
    if (inbox_.peer == from) return true;
    return !fixed_peer_ && receiver_.would_adopt(session, arrival);
  }

  asio::io_context context_;
  Udp::socket socket_;
  bool fixed_peer_;
  Receiver receiver_;  // from here to mailbox_: the receiving thread's
  Inbox inbox_{};
  Mailbox<Inbox> mailbox_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

UdpLink::UdpLink(const Config& config)
    : session_{draw_session()},
      sender_{session_},
      inbox_{std::make_unique<Inbox>()},
      socket_{std::make_unique<Socket>(config, session_)} {
  if (config.own_thread) refused_ = socket_->start(config.realtime);
}

UdpLink::~UdpLink() = default;

std::optional<PeerSample> UdpLink::receive() noexcept {
  look();
  if (inbox_->deliveries == returned_) return std::nullopt;
  returned_ = inbox_->deliveries;
  return inbox_->sample;
}

void UdpLink::send(const PeerState& state) noexcept {
  look();
  const Inbox& inbox = *inbox_;
  if (!inbox.peer) return;
  const bool taken = socket_->send(encode(sender_.step(state, inbox.heard, now())), *inbox.peer);
  ++(taken ? sent_ : unsent_);
}

LinkStatistics UdpLink::statistics() const noexcept {
  LinkStatistics statistics = inbox_->statistics;
  statistics.sent = sent_;
  return statistics;
}

bool UdpLink::wait() noexcept {
  expects(!socket_->has_thread(), "wait() is for links without a thread of their own");
  return socket_->receive_one();
}

std::uint16_t UdpLink::port() const { return socket_->port(); }

void UdpLink::look() noexcept { static_cast<void>(socket_->look(*inbox_)); }

void add_settings(Settings& settings, const std::string& prefix, UdpLink::Config& config) {
  settings.add(prefix + "bind", &config.bind, "own address, host:port; port 0 picks a free one");
  settings.add(prefix + "peer", &config.peer,
               "address of the other side, host:port; empty answers whoever speaks first");
  add_settings(settings, prefix + "receive.", config.realtime);
}

}  // namespace teleop
