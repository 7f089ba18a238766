#pragma once

#include <string>
#include <vector>

#include "core/base/settings.hpp"

namespace teleop {

/// What a loop asks of the system.
struct Realtime {
  bool enabled = true;
  int priority = 80;  ///< SCHED_FIFO, 1–99
  int core = -1;      ///< processor to stay on; -1 any
};

void add_settings(Settings& settings, const std::string& prefix, Realtime& realtime);

/// Locks the process's memory and holds the processors awake (/dev/cpu_dma_latency). Call once,
/// before threads are started: later memory is locked as it is first touched, so stacks stay small.
///
/// @returns what the system refused, a line each with its reason; empty when all was granted.
[[nodiscard]] std::vector<std::string> prepare_process();

/// Gives the calling thread a fixed real-time priority, its processor and timers without slack, and
/// touches its stack. Never call it from the loop.
///
/// @returns what the system refused, as above: the caller prints and records it.
[[nodiscard]] std::vector<std::string> prepare_thread(const Realtime& realtime);

/// Takes the calling thread back to ordinary scheduling: threads that a loop's thread starts for
/// its thinking inherit its priority, and would keep the loop waiting.
void leave_realtime() noexcept;

}  // namespace teleop
