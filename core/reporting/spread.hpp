#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/reporting/metrics.hpp"

namespace teleop {

/// How lateness, round trip and age are spread, as the page draws it: histograms on a log axis with
/// a row of counts a side and the pooled percentiles.
[[nodiscard]] nlohmann::json spread_data(const Run& run, const PairMetrics& metrics);

}  // namespace teleop
