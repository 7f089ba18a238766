#pragma once

#include <future>
#include <type_traits>

namespace teleop {

/// Asks the system for what a loop in real time needs, and says on stderr what was refused.
void ask_for_realtime_process();  ///< once, before threads are started
void ask_for_realtime_thread();   ///< in the loop's thread

/// Calls `body` on a thread of its own with real-time priority, and waits; the caller keeps its
/// ordinary one for pictures and files. Passes on what it returns or throws.
template <class Body>
std::invoke_result_t<Body&> on_realtime_thread(Body&& body) {
  ask_for_realtime_process();
  return std::async(std::launch::async,
                    [&body] {
                      ask_for_realtime_thread();
                      return body();
                    })
      .get();
}

}  // namespace teleop
