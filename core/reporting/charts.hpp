#pragma once

#include <string>

#include "core/reporting/metrics.hpp"

namespace teleop {

/// What the page draws, as JSON text that may stand inside a script element: the charts with their
/// series cut to the display, modes, limits and faults over time, and the histograms. The reader is
/// page.js; the layout is described at its head.
[[nodiscard]] std::string chart_data(const Run& run, const PairMetrics& metrics);

}  // namespace teleop
