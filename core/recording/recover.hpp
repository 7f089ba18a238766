#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace teleop {

/// What came of recovering a log.
struct Recovery {
  std::uint64_t kept = 0;          ///< records
  std::uint64_t lost = 0;          ///< records missing between kept ones, by their numbers
  std::uint64_t unread_bytes = 0;  ///< behind the place where the file is torn
  std::string damage{};            ///< in words; empty when the log was whole
};

/// Writes what can be read of the log `in` to the new file `out`, byte for byte the same messages,
/// with index, summary and footer. The metadata "recovered_from" and "damage" tell of it.
/// @throws RecordingError: `in` is no log or holds no readable record, `out` exists or cannot be
///         written.
Recovery recover_log(const std::filesystem::path& in, const std::filesystem::path& out);

/// "run.mcap" → "run.recovered.mcap", beside it.
[[nodiscard]] std::filesystem::path recovered_name(const std::filesystem::path& log);

}  // namespace teleop
