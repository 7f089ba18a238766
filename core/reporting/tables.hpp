#pragma once

#include <string>

#include "core/reporting/metrics.hpp"

namespace teleop {

// The parts of a report page that are text, as HTML.

/// The half dozen figures that come first.
[[nodiscard]] std::string key_figures(const PairMetrics& metrics);

/// Every figure, a column a side.
[[nodiscard]] std::string number_table(const PairMetrics& metrics);

/// What the logs say about themselves; one column where both say the same.
[[nodiscard]] std::string metadata_table(const Run& run);

}  // namespace teleop
