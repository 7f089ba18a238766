#pragma once

#include <string>
#include <vector>

#include "core/reporting/metrics.hpp"

namespace teleop {

/// What happened in a run, for somebody who was not there.
struct Words {
  std::string headline;               ///< the verdict, a few words
  std::vector<std::string> story;     ///< whole sentences, in the order of interest
  std::vector<std::string> troubles;  ///< what went wrong, a sentence each; empty after a clean run
};

[[nodiscard]] Words describe(const PairMetrics& metrics);

}  // namespace teleop
