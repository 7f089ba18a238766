#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/reporting/metrics.hpp"

namespace teleop {

/// The report of a run as one HTML page that needs nothing else: no network, no other file.
[[nodiscard]] std::string report_page(std::span<const Log> logs, const PairMetrics& metrics);

/// Writes the page, whole or not at all.
/// @throws ConfigError: `file` is one of the logs or cannot be written.
void write_report(const std::filesystem::path& file,
                  std::span<const Log> logs,
                  const PairMetrics& metrics);

}  // namespace teleop
