#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scenarios/concealed/plan.hpp"
#include "scenarios/scoring/rate_table.hpp"

namespace teleop {

/// The lines of a campaign (BlindStore), scored.
struct BlindReport {
  std::vector<Contestant> contestants{};  ///< the diagnosis first, then the regressions
  TextTable missed{};                     ///< cases of which the diagnosis did not say the best
  std::string sealed{};  ///< SHA-256 of all truths in order; empty while cases are missing
};

[[nodiscard]] BlindReport score_lines(const std::map<std::size_t, std::string>& lines,
                                      const concealed::ConcealedPlan& plan);

/// The figures as scripts read them.
[[nodiscard]] nlohmann::ordered_json json_of(const BlindReport& report,
                                             const concealed::ConcealedPlan& plan,
                                             std::size_t done);

}  // namespace teleop
