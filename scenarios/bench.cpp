#include "scenarios/bench.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scenarios/output.hpp"

namespace teleop {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

void report_rows(const std::vector<BenchRow>& rows, const BenchOptions& options) {
  nlohmann::json list = nlohmann::json::array();
  std::puts(fmt::format("{:<22} {:>8}  {:>12} {:>12}  {:<6} {:<7} {}", "figure", "ratio", "ours",
                        "peer", "unit", "better", "peer is")
                .c_str());
  for (const BenchRow& row : rows) {
    const char* better = row.lower_is_better ? "lower" : "higher";
    std::puts(fmt::format("{:<22} {:>8.3f}  {:>12.4g} {:>12.4g}  {:<6} {:<7} {}", row.id, row.ratio,
                          row.ours, row.peer, row.unit, better, row.peer_name)
                  .c_str());
    list.push_back({{"id", row.id},
                    {"ours", row.ours},
                    {"peer", row.peer},
                    {"peer_name", row.peer_name},
                    {"unit", row.unit},
                    {"ratio", row.ratio},
                    {"better", better}});
  }
  if (!options.json.empty()) write_json(options.json, {{"rows", list}});
}

}  // namespace teleop
