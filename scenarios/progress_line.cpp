#include "scenarios/progress_line.hpp"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace teleop {

ProgressLine::ProgressLine(std::size_t done_before, std::string things)
    : done_before_{done_before}, things_{std::move(things)} {}

void ProgressLine::show(std::size_t done, std::size_t total) {
  const auto now = WallClock::now();
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const auto finished = static_cast<double>(done - done_before_);
  const double left_s = elapsed_s / finished * static_cast<double>(total - done);
  const std::string line = fmt::format("{} of {} {}, {:.1f} s, about {:.0f} s left", done, total,
                                       things_, elapsed_s, left_s);
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\033[K{}{}", line, done == total ? "\n" : "");
  } else if (done == total || now - shown_ > std::chrono::seconds{10}) {
    fmt::print(stderr, "{}\n", line);
    shown_ = now;
  }
}

}  // namespace teleop
