#pragma once

#include <string>
#include <vector>

#include "scenarios/bench.hpp"

namespace teleop {

struct LinkBenchOptions {
  double seconds = 10.0;   ///< in all, at least one pair of blocks
  int round_trips = 5000;  ///< a block
  int priority = 80;       ///< SCHED_FIFO, of both ends of both
};

struct LinkBench {
  std::vector<BenchRow> rows;        ///< link_plain (p50) and link_plain_p99
  std::vector<std::string> refused;  ///< real-time requests that the system refused, to both alike
};

/// Round trips on loopback between two threads that block in their receive, in blocks that
/// alternate between
/// - ours: UdpLink there and back, which is encode, send, receive, check, decode, count, mailbox.
/// Each
///   end receives in wait(), so the hand-over to a second thread is not in the figure: in the field
///   the loop is not woken by packets but looks into the mailbox at its tick.
/// - the peer: sendto and recvfrom of as many bytes, nothing else.
///
/// `ours` and `peer` are medians over the blocks, `ratio` is the median of the blocks' ratios.
/// @throws TransportError when no packet comes back.
[[nodiscard]] LinkBench run_link_bench(const LinkBenchOptions& options);

}  // namespace teleop
