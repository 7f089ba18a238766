#include "scenarios/bench_tune.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

// found() is asked before a gain is read, which the checker does not see through.
// NOLINTBEGIN(bugprone-unchecked-optional-access)
struct Row {
  TuneCase one;
  TunedCase tuned;

  [[nodiscard]] bool found() const { return tuned.point.crossing.has_value() && one.margin; }
  [[nodiscard]] double error() const {
    return found() ? tuned.point.crossing->gain / one.margin->gain - 1.0 : 1.0;
  }
  [[nodiscard]] bool covered() const {
    return found() && tuned.point.crossing->low <= one.margin->gain &&
           one.margin->gain <= tuned.point.crossing->high;
  }
};

/// Cases in any order on several cores; a case depends on seed and number alone.
std::vector<Row> run_cases(const BenchTuneOptions& options) {
  std::vector<Row> rows(static_cast<std::size_t>(options.cases));
  std::atomic<std::size_t> next{0};
  std::atomic<int> done{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < rows.size(); i = next++) {
      rows[i].one = random_case(options.seed, i);
      rows[i].tuned = tune_case(rows[i].one);
      const int ready = ++done;
      if (ready % 20 == 0) fmt::print(stderr, "{} of {} cases\n", ready, options.cases);
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = options.threads > 0 ? static_cast<unsigned>(options.threads) : cores;
  std::vector<std::thread> pool;
  for (unsigned i = 1; i < threads; ++i) {
    pool.emplace_back(work);
  }
  work();
  for (std::thread& thread : pool) {
    thread.join();
  }
  return rows;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(place))];
}

void write_rows(const std::string& file, const std::vector<Row>& rows) {
  std::ofstream out{file};
  out << "case,experiment,mass_kg,damping,delay_ms,lag_ms,mode_Hz,quantum_um,analytic,analytic_Hz,"
         "gain,low,high,error,frequency_Hz,end,probes,arm_s,scatter,slope,speed,travel_mm,force,"
         "energy_mJ,within_bounds\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [one, tuned] = rows[i];
    const LinearAxis::Config& arm = one.loop.arms[0];
    const double reduced =
        arm.mass_kg * arm.second_mass_kg / std::max(arm.mass_kg + arm.second_mass_kg, 1e-9);
    const double mode = reduced > 0.0 ? std::sqrt(arm.joint_N_per_m / reduced) / 6.283185307 : 0.0;
    const Crossing c = tuned.point.crossing.value_or(Crossing{});
    const AnalyticMargin margin = one.margin.value_or(AnalyticMargin{});
    out << fmt::format(
        "{},{},{:.4f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.6g},{:.4g},{:.6g},{:.6g},{:.6g},{:.5f},"
        "{:.4g},{},{},{:.2f},{:.2f},{:.3g},{:.3f},{:.3f},{:.2f},{:.2f},{}\n",
        i, name_of(one.experiment), arm.mass_kg, arm.damping_Ns_per_m, 1e3 * arm.delay_s,
        1e3 * arm.lag_s, mode, 1e6 * one.quantum_m, margin.gain, margin.frequency_Hz, c.gain, c.low,
        c.high, rows[i].error(), tuned.point.frequency_Hz, name_of(tuned.point.end),
        tuned.point.probes.size(), tuned.point.arm_seconds, c.scatter_per_s, c.slope_per_s,
        tuned.true_speed_m_per_s, 1e3 * tuned.true_travel_m, tuned.true_force_N,
        1e3 * tuned.true_energy_J, tuned.within_bounds ? 1 : 0);
  }
  out.close();
  if (!out) throw ConfigError{fmt::format("{}: cannot be written", file)};
}

}  // namespace

int run_bench_tune(const BenchTuneOptions& options) {
  const std::vector<Row> rows = run_cases(options);
  const auto count = static_cast<double>(rows.size());
  const auto share = [&](auto&& holds) {
    return static_cast<double>(std::count_if(rows.begin(), rows.end(), holds)) / count;
  };
  std::vector<double> widths;
  std::vector<double> seconds;
  for (const Row& row : rows) {
    seconds.push_back(row.tuned.point.arm_seconds);
    if (row.found()) widths.push_back(row.tuned.point.crossing->relative_width());
  }
  const double found = share([](const Row& r) { return r.found(); });
  const double within = share([](const Row& r) { return std::abs(r.error()) <= 0.02; });
  const double coverage = share([](const Row& r) { return r.covered(); });
  const auto violations =
      std::count_if(rows.begin(), rows.end(), [](const Row& r) { return !r.tuned.within_bounds; });
  const nlohmann::json json{
      {"cases", rows.size()},
      {"seed", options.seed},
      {"found", found},
      {"within_2_percent", within},
      {"coverage_90", coverage},
      {"median_relative_width", quantile(widths, 0.5)},
      {"bound_violations", violations},
      {"arm_seconds", {{"p50", quantile(seconds, 0.5)}, {"p90", quantile(seconds, 0.9)}}}};
  if (!options.json.empty()) write_json(options.json, json);
  if (!options.cases_csv.empty()) write_rows(options.cases_csv, rows);
  fmt::print("within 2 % of the analytic margin  {:6.1f} %\n", 100.0 * within);
  fmt::print("90 % intervals cover it            {:6.1f} %\n", 100.0 * coverage);
  fmt::print("median width of the intervals      {:6.2f} %\n", 100.0 * quantile(widths, 0.5));
  fmt::print("searches that found a margin       {:6.1f} %\n", 100.0 * found);
  fmt::print("cases with a bound exceeded        {:6}\n", violations);
  fmt::print("arm time a point, median and p90   {:6.1f} s  {:.1f} s\n", quantile(seconds, 0.5),
             quantile(seconds, 0.9));
  return 0;
}

// NOLINTEND(bugprone-unchecked-optional-access)

}  // namespace teleop
