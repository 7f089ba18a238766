#include "core/recording/log.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/recording/mcap_reader.hpp"
#include "core/recording/tick_codec.hpp"

namespace teleop {

Log parse_log(std::span<const std::byte> bytes, const std::filesystem::path& name) {
  Log log{.file = name};
  std::uint64_t foreign = 0;
  McapScan scan = scan_mcap(bytes, kTickMessage, [&](const McapMessage& message) {
    if (const auto record = decode_tick(message.data)) {
      log.ticks.push_back(*record);
    } else {
      ++foreign;
    }
  });
  log.metadata = std::move(scan.metadata);
  log.damage = scan.damage_text();
  if (foreign > 0) {
    log.damage += fmt::format("{}{} records are no {}", log.damage.empty() ? "" : "; ", foreign,
                              kTickMessage);
  }
  log.complete = log.damage.empty();
  if (log.ticks.empty()) {
    throw RecordingError{fmt::format("{}: holds no readable record{}{}", name.string(),
                                     log.complete ? "" : ": ", log.damage)};
  }
  return log;
}

Log read_log(const std::filesystem::path& file) { return parse_log(read_mcap_file(file), file); }

}  // namespace teleop
