#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scenarios/tune.hpp"

namespace teleop {

/// "x", "y" or "z".
[[nodiscard]] std::string axis_name(std::size_t axis);

/// Number of the point with the smallest gain; the number of points where none was found.
[[nodiscard]] std::size_t worst_of(const std::vector<TunedPoint>& points);

/// The whole result for scripts.
[[nodiscard]] nlohmann::json report_json(const TuneOptions& options,
                                         const std::vector<TunedPoint>& points);

/// The table that people read.
[[nodiscard]] std::string report_table(const TuneOptions& options,
                                       const std::vector<TunedPoint>& points);

/// gnuplot scripts: the growth rates of one search, the gains over the workspace, and K over B.
[[nodiscard]] std::string search_picture(const TuneOptions& options, const TunedPoint& point);
[[nodiscard]] std::string workspace_gains_picture(const TuneOptions& options,
                                                  const std::vector<TunedPoint>& points,
                                                  const std::vector<Vector3>& outline);
[[nodiscard]] std::string kb_picture(const TuneOptions& options,
                                     const std::vector<TunedPoint>& points,
                                     const std::vector<std::pair<double, double>>& theory);

}  // namespace teleop
