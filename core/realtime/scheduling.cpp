#include "core/realtime/scheduling.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <system_error>

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace teleop {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// With a limit that is reached later, threads could no longer be started: better not to begin.
bool may_lock_all() noexcept {
  constexpr rlim_t kEnough = rlim_t{512} * 1024 * 1024;  // libraries and the stacks of all threads
  rlimit limit{};
  return geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur >= kEnough);
}

/// So that the loop's first deep call does not fault.
void touch_stack() noexcept {
  constexpr std::size_t kBytes = std::size_t{256} * 1024;
  constexpr std::size_t kPage = 4096;
  std::array<volatile std::byte, kBytes> stack{};
  for (std::size_t i = 0; i < kBytes; i += kPage) {
    stack[i] = std::byte{1};
  }
}

}  // namespace

void add_settings(Settings& settings, const std::string& prefix, Realtime& realtime) {
  settings.add(prefix + "realtime", &realtime.enabled, "ask for real-time scheduling");
  settings.add(prefix + "priority", &realtime.priority, "SCHED_FIFO priority", {1, 99});
  settings.add(prefix + "core", &realtime.core, "processor to stay on, -1 any", {-1, 1023});
}

std::vector<std::string> prepare_process() {
  std::vector<std::string> refused;
  // Everything mapped now is made resident; what comes later, as it is touched.
  if (!may_lock_all()) {
    refused.emplace_back(
        "memory stays pageable: the limit of locked memory is too low (ulimit -l)");
  } else if (mlockall(MCL_CURRENT) != 0 || mlockall(MCL_FUTURE | MCL_ONFAULT) != 0) {
    refused.push_back("memory stays pageable: " + reason(errno));
  }
  // The kernel keeps the request for as long as the file is open, which is the process's life.
  static const int latency = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t zero = 0;
  if (latency < 0 || write(latency, &zero, sizeof zero) != sizeof zero) {
    refused.push_back("processors may sleep deeply: /dev/cpu_dma_latency: " + reason(errno));
  }
  return refused;
}

std::vector<std::string> prepare_thread(const Realtime& realtime) {
  std::vector<std::string> refused;
  if (!realtime.enabled) {
    refused.emplace_back("real-time scheduling not asked for (loop.realtime = false)");
    return refused;
  }
  touch_stack();
  if (prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) != 0) {
    refused.push_back("timers keep their slack: " + reason(errno));
  }
  if (realtime.core >= 0) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(realtime.core), &cores);
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof cores, &cores)) {
      refused.push_back("not bound to core " + std::to_string(realtime.core) + ": " +
                        reason(error));
    }
  }
  const sched_param parameters{.sched_priority = realtime.priority};
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters)) {
    refused.push_back("ordinary scheduling instead of SCHED_FIFO: " + reason(error));
  }
  return refused;
}

void leave_realtime() noexcept {
  // Towards ordinary scheduling nothing is ever refused.
  const sched_param parameters{.sched_priority = 0};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameters));
}

}  // namespace teleop
