#pragma once

#include <complex>
#include <functional>
#include <optional>

namespace teleop {

/// A tool that is read, damped and held: M v̇ + b v = f, the force held for a period, x read just
/// before it changes.
struct SampledMass {
  double mass_kg = 0.05;          ///< M
  double damping_Ns_per_m = 0.0;  ///< b, physical
  double period_s = 1e-3;         ///< T

  /// P(e^{jωT}), place over force, exact, m/N.
  [[nodiscard]] std::complex<double> response(double omega_rad_per_s) const noexcept;
};

struct DampingLimit {
  double damping_Ns_per_m = 0.0;  ///< B at which the loop oscillates without growing or dying
  double frequency_Hz = 0.0;      ///< at which it does
};

/// Where the loop is looked at: evenly spaced in the logarithm.
struct FrequencyGrid {
  double lowest_Hz = 0.2;
  double highest_Hz = 500.0;  ///< at most 1/(2T)
  int points = 600;
};

/// The largest virtual damping B of f = −B v̂, where v̂ = H x. The loop is stable for small B, and
/// its first eigenvalue reaches the unit circle at e^{jωT} where 1 + B H P = 0: the least
/// B = −1/(H P) over all ω at which H P is real and negative. Exact for a linear estimator; for a
/// describing function it is the B that sustains the oscillation of that amplitude.
///
/// For a mean of N first differences and b = 0 about M π²/(2 N T) [Cavusoglu 2002, section 4.2.2
/// worked out].
///
/// @param H  estimate over place at ω, 1/s
/// @returns nothing when no B destabilises it within the grid.
[[nodiscard]] std::optional<DampingLimit> damping_limit(
    const SampledMass& mass,
    const std::function<std::complex<double>(double)>& H,
    const FrequencyGrid& grid);

}  // namespace teleop
