#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/tuning/oscillation.hpp"
#include "core/tuning/probe.hpp"
#include "core/tuning/probe_run.hpp"

namespace teleop {

/// What a probe says about its gain.
enum class Verdict : std::uint8_t {
  quiet = 0,      ///< nothing oscillated: the push died away
  decays = 1,     ///< an oscillation died
  grows = 2,      ///< an oscillation grew, or a bound was hit
  small = 3,      ///< what oscillates is no larger than three counts: rounding or friction, a limit
                  ///< cycle that the gain of marginal stability has nothing to do with
  overshot = 4,   ///< the push alone passed the ceiling: says nothing but that it was too strong
  undershot = 5,  ///< nothing oscillated, after a push too weak to tell
  disturbed = 6,  ///< the loop lost turns, or it was not at rest before the push: says nothing
};
[[nodiscard]] std::string_view name_of(Verdict verdict) noexcept;

/// One entry of a mode shape: how far one axis of one tool moves in the oscillation, relative to
/// the largest entry, and when.
struct ShapeEntry {
  std::size_t arm = 0;
  std::size_t axis = 0;
  double ratio = 0.0;      ///< 0 to 1
  double phase_rad = 0.0;  ///< against the largest
};

/// A finished probe: plan, what happened, and what the trace shows.
struct ProbeResult {
  ProbePlan plan{};
  ProbeOutcome outcome{};
  ProbeRunner::Timing timing{};
  Verdict verdict = Verdict::quiet;
  std::optional<Oscillation> oscillation{};  ///< amplitudes of the tool that moves most, m
  std::vector<Oscillation> others{};  ///< that stood out beside it, in the units of the signal
  std::vector<ShapeEntry> shape{};
};

struct Analysis {
  GainExperiment experiment = GainExperiment::wall;
  std::size_t axis = 0;
  double quantum_m = 0.0;
  double period_s = 1e-3;  ///< of the loop
};

/// Looks at a trace: the oscillation of the tool, or of the distance between both, and its shape.
/// Thread: any; it allocates, so not for a loop.
[[nodiscard]] ProbeResult analyse(const Analysis& how,
                                  const ProbePlan& plan,
                                  const ProbeOutcome& outcome,
                                  const ProbeRunner::Timing& timing,
                                  const ProbeTrace& trace);

}  // namespace teleop
