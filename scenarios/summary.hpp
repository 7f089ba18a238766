#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/reporting/metrics.hpp"

namespace teleop {

/// A run as a table for a terminal, with what went wrong in words below; `files` are named last.
[[nodiscard]] std::string summary_text(const PairMetrics& metrics,
                                       const std::vector<std::filesystem::path>& files);

}  // namespace teleop
