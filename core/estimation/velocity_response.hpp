#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "core/estimation/velocity_estimator.hpp"

namespace teleop {

/// A velocity estimator on one joint that is read evenly.
struct EvenVelocity {
  VelocityEstimator::Config config{};
  double counts_per_rev = 40'000.0;
  double period_s = 1e-3;  ///< Δt
};

/// Whether the estimate is a linear function of the samples of q, once settled: difference, mean,
/// kalman.
[[nodiscard]] bool is_linear(const VelocityEstimator::Config& config) noexcept;

/// A linear estimator as what it makes of one sample that is 1 rad off, sample by sample until
/// nothing is left: h, 1/s. Taken from the estimator itself, so no formula can depart from it.
/// @pre is_linear(estimator.config)
[[nodiscard]] std::vector<double> impulse_response(const EvenVelocity& estimator);

/// H(e^{jωΔt}) = Σ h[k] e^{−jωkΔt}, estimate over angle, 1/s. An ideal estimate has jω.
[[nodiscard]] std::complex<double> response(std::span<const double> impulse_response,
                                            double period_s,
                                            double omega_rad_per_s) noexcept;

/// The lag of a linear estimate of slow motion, s: Σ ½ k² h[k] Δt² of a parabola of acceleration 1.
[[nodiscard]] double lag_s(std::span<const double> impulse_response, double period_s) noexcept;

/// Deviation of the estimate from white noise of deviation 1 rad in every sample: √Σ h², 1/s.
[[nodiscard]] double noise_gain(std::span<const double> impulse_response) noexcept;

/// The describing function of any estimator [Gelb 1968]: the fundamental of its estimate of
/// A sin ωt, read through an encoder with rounding and period counter, over A; averaged over where
/// in a count the motion has its middle.
[[nodiscard]] std::complex<double> describing_function(const EvenVelocity& estimator,
                                                       double amplitude_rad,
                                                       double omega_rad_per_s);

}  // namespace teleop
