#pragma once

#include <span>
#include <vector>

#include "core/tuning/modes.hpp"

namespace teleop {

/// A piece of a free response. Samples need not be exactly uniform in time: each has its instant.
struct Record {
  std::span<const double> t_s;
  std::span<const double> y;
};

/// One oscillation in a record.
struct Oscillation {
  double growth_per_s = 0.0;      ///< σ at `amplitude_here`
  double growth_std_per_s = 0.0;  ///< one standard deviation
  double frequency_Hz = 0.0;
  double frequency_std_Hz = 0.0;
  double amplitude_start = 0.0;  ///< of the fitted envelope at the record's ends, units of y
  double amplitude_end = 0.0;
  double amplitude_here = 0.0;  ///< where σ was taken: `amplitude_wanted`, or the nearest to it
  double residual_std = 0.0;
  int modes = 0;  ///< fitted, this one included

  /// Whether σ is known well enough to count: a third of itself, or 1.5 1/s.
  [[nodiscard]] bool is_rated() const noexcept {
    const double size = growth_per_s < 0.0 ? -growth_per_s : growth_per_s;
    return growth_std_per_s > 0.0 && growth_std_per_s < 0.3 * (size + 5.0);
  }
};

/// All that stand out of the noise, the one that dies slowest or grows fastest first: the dominant
/// one. Fits, by least squares over all parameters together,
///
///     y(t) = Σ_i A_i e^{σ_i τ + ½ ρ_i τ²} cos(ω_i τ + φ_i) + c_0 + c_1 τ + noise,
///
/// τ counted from the record's middle, the modes started from find_modes(). The bend ρ belongs to
/// the dominant mode alone and only where it stands out by three deviations: it lets the growth
/// depend on amplitude, as friction and quantisation make it, and σ + ρ τ is taken at the instant
/// at which the envelope has `amplitude_wanted` (inside the middle half of the record). Variances
/// come from the residual, its correlation from one sample to the next included.
///
/// Empty when no oscillation stands out, or the record is too short for one (12 samples).
/// Thread: any; it allocates, so not for a loop.
[[nodiscard]] std::vector<Oscillation> fit_oscillations(const Record& record,
                                                        double noise_std,
                                                        double amplitude_wanted);

/// Amplitude and phase of another channel in a known oscillation, by linear least squares over the
/// same record: y ≈ e^{σ τ} (a cos ω τ + b sin ω τ) + c_0 + c_1 τ, τ from the record's middle.
struct Phasor {
  double in_phase = 0.0;    ///< a
  double quadrature = 0.0;  ///< b
};
[[nodiscard]] Phasor phasor_of(const Record& record, const FreeMode& mode);

}  // namespace teleop
