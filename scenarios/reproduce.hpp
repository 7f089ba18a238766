#pragma once

#include <string>
#include <vector>

#include "scenarios/paper_rows.hpp"

namespace teleop {

struct ReproduceOptions {
  bool fit = false;                 ///< search the declared set within its bounds first
  bool quick = false;               ///< analysis instead of experiments
  std::vector<std::string> rows{};  ///< ids of those that are wanted; empty: all
  std::string json{};               ///< file for the numbers; empty: none
};

/// What a row may be called: "fitted" when its target chose a parameter, "predicted" when none did
/// and it comes out within a tenth, else "not_reproduced".
[[nodiscard]] std::string status_of(PaperRowId row, double ours, const PaperSet& set);

/// By how many percent a row moves when a parameter moves by one; for a parameter that is zero,
/// when it moves by a tenth of its range. From the analysis.
[[nodiscard]] double sensitivity(PaperRowId row, const PaperSet& set, PaperSet::Index parameter);

/// `teleop reproduce`: the table of [Cavusoglu 2002], each row beside the paper's figure, with the
/// drive model that the row needs; the same with one drive model throughout; what was assumed, and
/// how much each row depends on it.
/// @returns the exit code: 0 also where rows are not reproduced, for that is a result.
/// @throws ConfigError when the file cannot be written.
[[nodiscard]] int run_reproduce(const ReproduceOptions& options);

}  // namespace teleop
