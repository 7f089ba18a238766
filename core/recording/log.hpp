#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/recording/tick_record.hpp"

namespace teleop {

/// Free text about a run, by name: "role", "arm", "rate_Hz", "config", "seed", "realtime" …
using Metadata = std::map<std::string, std::string>;

/// A recording of one side, read whole.
struct Log {
  std::filesystem::path file{};
  Metadata metadata{};
  std::vector<TickRecord> ticks{};
  bool complete = true;  ///< false: the file was cut off (no footer) or a damaged chunk was skipped
  std::string damage{};  ///< what was wrong, in words; empty when complete
};

/// Reads a log, a cut-off one up to its last whole record.
/// @throws RecordingError: no such file, not a log, no readable record.
[[nodiscard]] Log read_log(const std::filesystem::path& file);

/// The same of a log's bytes, which begin with MCAP's magic; `name` stands for the file.
[[nodiscard]] Log parse_log(std::span<const std::byte> bytes, const std::filesystem::path& name);

}  // namespace teleop
