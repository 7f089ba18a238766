#pragma once

#include <cstdint>
#include <vector>

#include "core/recording/log.hpp"

namespace teleop {

/// Turns one side's stamps into seconds since the run began, on the master's clock.
///
/// Both sides on one machine (equal metadata "host") read the same monotonic clock and need no
/// correction. On two machines the offset of the clocks is seen through the packets: with
///
///     a = min (received_m − sent_s),   b = min (received_s − sent_m)
///
/// over ten seconds, offset = (a − b) / 2, and half the smallest round trip, (a + b) / 2, bounds
/// its error [RFC 5905, section 8]. Between the windows the offset is interpolated, so drift is
/// followed.
class RunClock {
 public:
  /// The slave's, as seen from the master's.
  [[nodiscard]] static RunClock of_slave(const Log& master, const Log& slave);

  [[nodiscard]] double seconds(std::int64_t stamp_ns) const noexcept;

  /// The master's stamp that becomes 0 s.
  void begin_at(std::int64_t begin_ns) noexcept { begin_ns_ = begin_ns; }

  /// How far times of the two sides may be apart, worst window; 0 on one machine.
  [[nodiscard]] double error_bound_us() const noexcept { return error_bound_us_; }

  /// Two machines, and no packet went both ways: times of the two sides cannot be compared.
  [[nodiscard]] bool unknown() const noexcept { return unknown_; }

 private:
  struct Node {
    std::int64_t stamp_ns = 0;   ///< middle of the window, own clock
    std::int64_t offset_ns = 0;  ///< master's clock minus own
  };

  [[nodiscard]] std::int64_t offset_ns(std::int64_t stamp_ns) const noexcept;

  std::vector<Node> nodes_;
  std::int64_t begin_ns_ = 0;
  double error_bound_us_ = 0.0;
  bool unknown_ = false;
};

}  // namespace teleop
