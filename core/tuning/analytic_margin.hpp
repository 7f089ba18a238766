#pragma once

#include <optional>

#include "core/tuning/sampled_loop.hpp"

namespace teleop {

/// Which of the two gains of a loop is looked for.
enum class TunedGain { stiffness, damping };

struct AnalyticMargin {
  double gain = 0.0;  ///< N/m or N s/m
  double frequency_Hz = 0.0;
};

/// The smallest gain at which the loop has a pole on the unit circle, away from z = 1, the other
/// gain as it is [Nyquist]. At each frequency the loop's equation is solved for the law
/// c = G + B D(z) that puts a pole at z = e^{jωT},
///
///     one arm    1 + c P = 0
///     two arms   1 + c (P_1 + P_2) + c² P_1 P_2 (1 − z^{−2p}) = 0,
///
/// and the gain that this takes is looked through for real, positive values. A loop that is stable
/// with vanishing gain is stable exactly below it. Absent where no gain does. Precise to 1e-9.
/// @pre is_linear(loop).
[[nodiscard]] std::optional<AnalyticMargin> nyquist_margin(const SampledLoop& loop,
                                                           TunedGain tuned);

/// The same by the eigenvalues of the transition: the smallest gain above `from` at which the
/// spectral radius passes 1, within a relative 1e-7; in steps of 5 % up to `to`. Absent where none
/// does; zero where the loop is not stable at `from`. Slow for estimators over many samples.
[[nodiscard]] std::optional<AnalyticMargin> eigenvalue_margin(const SampledLoop& loop,
                                                              TunedGain tuned,
                                                              double from,
                                                              double to);

}  // namespace teleop
