#pragma once

#include <span>
#include <vector>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// Zero-phase smoothing of a record that is there as a whole, evenly sampled or not: every sample
/// is weighed with exp(−(t − t_k)²/2σ²), |t − t_k| ≤ 4σ, and a polynomial is fitted by least
/// squares. Not causal: for looking back at recordings, never for a loop.

/// The slope of a cubic: the speed that a recording had, up to `bandwidth_Hz`. Evenly sampled, it
/// has no phase and the gain (1 + s) e^{−s}, s = (ωσ)²/2, which is 1/√2 at ωσ = 1.47; σ is chosen
/// so.
/// @pre times rise, as many as values; bandwidth is positive
[[nodiscard]] std::vector<JointVector> zero_phase_velocity(std::span<const double> times_s,
                                                           std::span<const JointVector> values,
                                                           double bandwidth_Hz);

/// The weighed mean: a low-pass e^{−s}, 1/√2 at `bandwidth_Hz` (ωσ = 0.833).
[[nodiscard]] std::vector<JointVector> zero_phase_mean(std::span<const double> times_s,
                                                       std::span<const JointVector> values,
                                                       double bandwidth_Hz);

/// How far from an end zero_phase_velocity() sees less than its whole window, s.
[[nodiscard]] double zero_phase_margin_s(double bandwidth_Hz) noexcept;

}  // namespace teleop
