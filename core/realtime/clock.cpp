#include "core/realtime/clock.hpp"

#include <cerrno>
#include <ctime>

namespace teleop {

Instant SystemClock::now() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Instant{std::chrono::seconds{t.tv_sec} + std::chrono::nanoseconds{t.tv_nsec}};
}

void SystemClock::sleep_until(Instant when) noexcept {
  constexpr std::int64_t kBillion = 1'000'000'000;
  const std::int64_t ns = when.time_since_epoch().count();
  const timespec t{.tv_sec = ns / kBillion, .tv_nsec = ns % kBillion};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace teleop
