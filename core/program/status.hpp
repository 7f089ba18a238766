#pragma once

#include <cstdint>
#include <string>

#include "core/ports/link.hpp"
#include "core/ports/peer.hpp"
#include "core/realtime/histogram.hpp"
#include "core/realtime/loop.hpp"
#include "core/recording/tick_record.hpp"

namespace teleop {

/// What a running side shows of itself, several times a second.
struct Status {
  TickRecord record{};  ///< the newest turn
  LinkStatistics link{};
  std::uint64_t turns = 0;
  std::uint64_t missed = 0;   ///< turns of the schedule that never happened
  std::uint64_t dropped = 0;  ///< turns missing in the recording
};

/// One line for a terminal.
[[nodiscard]] std::string status_line(Role role, const Status& status, const Histogram& lateness);

/// The same as one line of JSON, for a program that started this one.
[[nodiscard]] std::string status_json(Role role, const Status& status, const Histogram& lateness);

}  // namespace teleop
