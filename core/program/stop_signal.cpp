#include "core/program/stop_signal.hpp"

#include <csignal>
#include <ctime>

namespace teleop {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

bool StopSignal::wait(Duration patience) {
  if (asked()) return true;
  const sigset_t set = stop_signals();
  constexpr std::int64_t kBillion = 1'000'000'000;
  const timespec limit{.tv_sec = patience.count() / kBillion,
                       .tv_nsec = patience.count() % kBillion};
  if (sigtimedwait(&set, nullptr, &limit) > 0) ask();
  return asked();
}

}  // namespace teleop
