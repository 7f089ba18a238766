#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/tuning/experiment.hpp"
#include "core/tuning/marginal_search.hpp"
#include "core/tuning/probe_run.hpp"

namespace teleop {

/// The search at one pose, along one axis.
struct PointConfig {
  ExperimentConfig experiment{};
  MarginalSearch::Config search{};  ///< experiment, period, quantum and bounds are filled in
  ProbeBounds bounds{};
  double amplitude_m = 0.0;                            ///< A; 0: the default of the arm's quantum
  std::function<void(const ProbeResult&)> on_probe{};  ///< after each probe, before the next
  std::function<bool()> stop_asked{};                  ///< true: leave, arms at rest
};

struct PointResult {
  SearchEnd end = SearchEnd::gave_up;
  bool stopped = false;  ///< stop_asked() said so
  std::optional<Crossing> crossing{};
  double frequency_Hz = 0.0;        ///< of the oscillation at the crossing
  double amplitude_m = 0.0;         ///< A that was used
  std::vector<ShapeEntry> shape{};  ///< of the probe nearest to the crossing
  std::vector<ProbeResult> probes{};
  double arm_seconds = 0.0;
};

/// Finds the marginal gain: probe, thought, probe, … on the arms behind `ports`, which have to
/// stand near the poses of `frames`. `history` is what an aborted search had done; its probes are
/// not repeated. At the end the arms rest and the amplifiers are off.
/// @throws ConfigError when an estimator or the search cannot be had.
[[nodiscard]] PointResult tune_point(const PointConfig& config,
                                     const std::vector<ToolFrame>& frames,
                                     const ProbeRunner::Ports& ports,
                                     std::vector<ProbeResult> history = {});

/// The coarsest quantum of the arms along the axis, m.
[[nodiscard]] double quantum_of(const std::vector<ToolFrame>& frames, std::size_t axis);

}  // namespace teleop
