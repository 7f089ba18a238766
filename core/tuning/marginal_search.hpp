#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/tuning/crossing.hpp"
#include "core/tuning/experiment.hpp"
#include "core/tuning/probe_result.hpp"

namespace teleop {

/// How a search ended, or that it goes on. Numbers are part of the journal.
enum class SearchEnd : std::uint8_t {
  goes_on = 0,
  found = 1,            ///< the interval is as narrow as asked
  wide = 2,             ///< probes or arm time ran out; the interval is what there is
  no_limit = 3,         ///< stable up to the largest gain that was allowed
  force_limited = 4,    ///< stable up to a gain whose forces leave no room for an oscillation
  always_unstable = 5,  ///< unstable at the smallest gain tried
  gave_up = 6,          ///< the arm does not rest, or disturbances do not end
};
[[nodiscard]] std::string_view name_of(SearchEnd end) noexcept;

/// Finds the gain of marginal stability by asking for one probe after the other. It is a function
/// of the probes so far and nothing else, so a search resumes from its journal and repeats itself.
///
///     explore   the gain rises by a factor of 3 while nothing oscillates, less when something
///     does,
///               and towards where the growth rates say that they pass zero
///     bracket   between the largest stable and the smallest unstable gain: secant on growth rates
///     refine    gains a little to either side of the crossing, pushes sized so that the
///     oscillation
///               passes amplitude A in the middle of the watch, watches as long as the growth
///               rate's precision needs; a line through all growth rates near it gives the interval
class MarginalSearch {
 public:
  struct Config {
    GainExperiment experiment = GainExperiment::wall;
    double period_s = 1e-3;
    double memory_s = 0.02;     ///< of the law: as in ProbePlan
    double quantum_m = 27e-6;   ///< of the coarsest tool
    double amplitude_m = 3e-4;  ///< A, see default_amplitude()
    double start_gain = 0.0;    ///< 0: of the experiment
    double most_gain = 0.0;     ///< 0: of the experiment
    double width = 0.01;        ///< of the 90 % interval, relative
    int most_probes = 100;
    double most_arm_seconds = 120.0;
    ProbeBounds bounds{};
  };

  struct Step {
    std::optional<ProbePlan> plan{};  ///< absent at the end
    SearchEnd end = SearchEnd::goes_on;
    std::optional<Crossing> crossing{};
  };

  /// The larger of 10 counts and 0.3 mm.
  [[nodiscard]] static double default_amplitude(double quantum_m) noexcept;

  explicit MarginalSearch(const Config& config);

  [[nodiscard]] Step next(std::span<const ProbeResult> probes) const;

  [[nodiscard]] const Config& config() const noexcept { return config_; }

 private:
  Config config_;
};

}  // namespace teleop
