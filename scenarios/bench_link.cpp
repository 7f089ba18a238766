#include "scenarios/bench_link.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/realtime/scheduling.hpp"
#include "transport/udp_link.hpp"

namespace teleop {
namespace {

constexpr int kWarmUp = 200;
constexpr int kPatience = 40;  // of timeouts of 50 ms

/// Two links, each received in its caller's thread.
class LinkPair {
 public:
  bool ask() {
    master_.send(state_);
    for (int i = 0; i < kPatience; ++i) {
      if (master_.wait() && master_.receive()) return true;
    }
    return false;
  }

  void answer() {
    if (!slave_.wait()) return;
    if (const auto sample = slave_.receive()) slave_.send(sample->state);
  }

 private:
  UdpLink slave_{{.bind = "127.0.0.1:0", .own_thread = false}};
  UdpLink master_{{.bind = "127.0.0.1:0",
                   .peer = "127.0.0.1:" + std::to_string(slave_.port()),
                   .own_thread = false}};
  PeerState state_{.p_BT = {0.1, 0.2, 0.3}};
};

/// What a C program would do, with packets of the same size.
class BarePair {
 public:
  bool ask() {
    send(here_, packet_.size(), there_address_);
    for (int i = 0; i < kPatience; ++i) {
      if (recvfrom(here_, packet_.data(), packet_.size(), 0, nullptr, nullptr) > 0) return true;
    }
    return false;
  }

  void answer() {
    std::array<std::byte, kPacketSize> bytes;  // NOLINT: filled by the system
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t length =
        recvfrom(there_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (length > 0) {
      sendto(there_, bytes.data(), static_cast<std::size_t>(length), 0,
             reinterpret_cast<sockaddr*>(&from), size);
    }
  }

  BarePair() : here_{open()}, there_{open()} {
    socklen_t size = sizeof there_address_;
    getsockname(there_, reinterpret_cast<sockaddr*>(&there_address_), &size);
  }
  BarePair(const BarePair&) = delete;
  BarePair& operator=(const BarePair&) = delete;
  BarePair(BarePair&&) = delete;
  BarePair& operator=(BarePair&&) = delete;
  ~BarePair() {
    close(here_);
    close(there_);
  }

 private:
  static int open() {
    const int file = socket(AF_INET, SOCK_DGRAM, 0);
    if (file < 0) throw TransportError{"no UDP socket can be opened; is IPv4 switched off?"};
    const timeval timeout{.tv_sec = 0, .tv_usec = UdpLink::kWait.count()};
    setsockopt(file, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(file, reinterpret_cast<sockaddr*>(&own), sizeof own) != 0) {
      throw TransportError{"127.0.0.1: a socket cannot be bound; is the loopback interface up?"};
    }
    return file;
  }
  void send(int file, std::size_t length, const sockaddr_in& to) {
    sendto(file, packet_.data(), length, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

  int here_;
  int there_;
  sockaddr_in there_address_{};
  std::array<std::byte, kPacketSize> packet_{};
};

struct Block {
  double p50_us = 0.0;
  double p99_us = 0.0;
};

Block summarise(std::vector<double>& round_trips_us) {
  std::sort(round_trips_us.begin(), round_trips_us.end());
  const auto at = [&](double q) {
    return round_trips_us[static_cast<std::size_t>(q * double(round_trips_us.size() - 1))];
  };
  return {.p50_us = at(0.5), .p99_us = at(0.99)};
}

/// One block, each end in a thread of its own with the same real-time rights.
template <class Pair>
Block run_block(Pair& pair, const LinkBenchOptions& options, std::vector<std::string>& refused) {
  const Realtime realtime{.priority = options.priority};
  std::vector<double> round_trips_us;
  round_trips_us.reserve(static_cast<std::size_t>(options.round_trips));
  std::atomic<bool> done{false};
  bool lost = false;
  std::thread answering{[&] {
    static_cast<void>(prepare_thread(realtime));
    while (!done.load(std::memory_order_relaxed)) {
      pair.answer();
    }
  }};
  std::thread asking{[&] {
    refused = prepare_thread(realtime);
    for (int i = -kWarmUp; i < options.round_trips && !lost; ++i) {
      const Instant start = std::chrono::steady_clock::now();
      lost = !pair.ask();
      const Instant end = std::chrono::steady_clock::now();
      if (i >= 0) round_trips_us.push_back(1e6 * seconds(end - start));
    }
  }};
  asking.join();
  done = true;
  answering.join();
  if (lost) throw TransportError{"127.0.0.1: packets do not come back; is a firewall in the way?"};
  return summarise(round_trips_us);
}

BenchRow row_of(const std::string& id,
                const std::vector<Block>& ours,
                const std::vector<Block>& peer,
                double Block::* figure) {
  std::vector<double> own;
  std::vector<double> bare;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    own.push_back(ours[i].*figure);
    bare.push_back(peer[i].*figure);
    ratios.push_back(own.back() / bare.back());
  }
  return {.id = id,
          .ours = median(own),
          .peer = median(bare),
          .peer_name = "bare C sockets",
          .unit = "us",
          .ratio = median(ratios)};
}

}  // namespace

LinkBench run_link_bench(const LinkBenchOptions& options) {
  LinkBench bench;
  LinkPair links;
  BarePair sockets;
  std::vector<Block> ours;
  std::vector<Block> peer;
  const Instant start = std::chrono::steady_clock::now();
  do {
    // The order turns round every pair, so that a machine that speeds up favours neither.
    if (ours.size() % 2 == 0) {
      ours.push_back(run_block(links, options, bench.refused));
      peer.push_back(run_block(sockets, options, bench.refused));
    } else {
      peer.push_back(run_block(sockets, options, bench.refused));
      ours.push_back(run_block(links, options, bench.refused));
    }
  } while (seconds(std::chrono::steady_clock::now() - start) < options.seconds);
  bench.rows = {row_of("link_plain", ours, peer, &Block::p50_us),
                row_of("link_plain_p99", ours, peer, &Block::p99_us)};
  return bench;
}

int bench_link(const BenchOptions& options) {
  const LinkBench bench = run_link_bench({.seconds = options.seconds});
  for (const std::string& line : bench.refused) {
    std::fprintf(stderr, "real time: %s\n", line.c_str());
  }
  report_rows(bench.rows, options);
  return 0;
}

}  // namespace teleop
