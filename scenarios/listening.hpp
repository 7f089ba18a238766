#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

#include "core/program/stop_signal.hpp"

namespace teleop {

/// Calls `body` on a thread of its own while this one hears Ctrl-C and sets `asked`.
/// @throws what `body` throws.
template <class Body>
void run_while_listening(std::atomic<bool>& asked, Body&& body) {
  StopSignal stop;
  std::atomic<bool> done{false};
  std::exception_ptr error;
  std::thread worker{[&] {
    try {
      body();
    } catch (...) {
      error = std::current_exception();
    }
    done = true;
  }};
  while (!done) {
    if (stop.wait(std::chrono::milliseconds{20})) asked = true;
  }
  worker.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace teleop
