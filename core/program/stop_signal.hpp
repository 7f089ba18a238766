#pragma once

#include <atomic>
#include <optional>

#include "core/base/time.hpp"

namespace teleop {

/// SIGINT and SIGTERM as a value instead of an interruption. Make one before any thread is started:
/// every thread then inherits the blocked signals and the main thread waits for them.
class StopSignal {
 public:
  StopSignal();

  /// Waits at most `patience`. @returns true once a stop was asked for.
  bool wait(Duration patience);

  /// Any thread: asks for the stop.
  void ask() noexcept { asked_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> asked_{false};
};

}  // namespace teleop
