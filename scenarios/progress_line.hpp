#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace teleop {

/// The line on stderr that tells how far a long work is and how much time is left: in place on a
/// terminal, else now and then.
class ProgressLine {
 public:
  /// @param done_before what had been done when this program began, @param things in the plural
  ProgressLine(std::size_t done_before, std::string things);

  void show(std::size_t done, std::size_t total);

 private:
  using WallClock = std::chrono::steady_clock;

  std::size_t done_before_;
  std::string things_;
  WallClock::time_point begin_ = WallClock::now();
  WallClock::time_point shown_ = begin_;
};

}  // namespace teleop
