#include "scenarios/loop_thread.hpp"

#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/realtime/scheduling.hpp"

namespace teleop {
namespace {

void show(const std::vector<std::string>& refusals) {
  for (const std::string& line : refusals) {
    fmt::print(stderr, "real time: {}\n", line);
  }
}

}  // namespace

void ask_for_realtime_process() { show(prepare_process()); }

void ask_for_realtime_thread() { show(prepare_thread({})); }

}  // namespace teleop
