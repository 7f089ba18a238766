#include "core/reporting/tick.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {

Role role_of(const Log& log) {
  const auto role = log.metadata.find("role");
  if (role != log.metadata.end()) {
    if (role->second == name_of(Role::master)) return Role::master;
    if (role->second == name_of(Role::slave)) return Role::slave;
  }
  throw RecordingError{
      fmt::format("{}: does not say whether it is of the master or the slave (metadata 'role'); "
                  "give a log that "
                  "teleop-master or teleop-slave wrote",
                  log.file.string())};
}

double nominal_rate(const Log& log) {
  if (const auto rate = log.metadata.find("rate_Hz"); rate != log.metadata.end()) {
    const std::string& text = rate->second;
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && std::isfinite(value) && value > 0.0) return value;
  }
  std::vector<double> turns_ms;
  turns_ms.reserve(log.ticks.size());
  for (const TickRecord& record : log.ticks) {
    if (record.elapsed_ms > 0.0) turns_ms.push_back(record.elapsed_ms);
  }
  if (turns_ms.empty()) return 0.0;
  const auto middle = turns_ms.begin() + static_cast<std::ptrdiff_t>(turns_ms.size() / 2);
  std::nth_element(turns_ms.begin(), middle, turns_ms.end());
  return 1000.0 / *middle;
}

}  // namespace teleop
