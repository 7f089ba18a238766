#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/simulation/linear_arm.hpp"
#include "core/tuning/analytic_margin.hpp"
#include "core/tuning/tune_point.hpp"

namespace teleop {

struct BenchTuneOptions {
  int cases = 200;
  std::uint64_t seed = 1;
  int threads = 0;        ///< 0: one a core
  std::string json;       ///< file for the figures; empty: none
  std::string cases_csv;  ///< file for a row a case; empty: none
};

/// A random linear plant with the loop that is tried on it: mass 20–120 g, damping 0.2–5 N s/m,
/// delay 0–2.9 samples, amplifier lag 0–1 ms, half with a mode of 40–250 Hz, quantum 10–60 µm, a
/// third for each experiment.
struct TuneCase {
  GainExperiment experiment = GainExperiment::wall;
  std::size_t axis = 0;
  SampledLoop loop{};
  double quantum_m = 0.0;
  std::optional<AnalyticMargin> margin{};
};
[[nodiscard]] TuneCase random_case(std::uint64_t seed, std::size_t index);

/// What a search on such a plant came to. The largest motions are the plant's own, whatever the
/// tuner noticed.
struct TunedCase {
  PointResult point{};
  double true_speed_m_per_s = 0.0;
  double true_travel_m = 0.0;
  double true_force_N = 0.0;
  double true_energy_J = 0.0;  ///< largest that the motors had put in since a probe began
  bool within_bounds = false;
};
[[nodiscard]] TunedCase tune_case(const TuneCase& one);

/// @throws ConfigError when a file cannot be written.
[[nodiscard]] int run_bench_tune(const BenchTuneOptions& options);

}  // namespace teleop
