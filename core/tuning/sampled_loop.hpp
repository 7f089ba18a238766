#pragma once

#include <complex>
#include <vector>

#include <Eigen/Core>

#include "core/estimation/velocity_estimator.hpp"
#include "core/simulation/linear_axis.hpp"

namespace teleop {

/// One axis of one arm against the ground, or of two arms against each other, under a sampled law:
///
///     one arm    u[k]   = −(G y[k] + B v[k])
///     two arms   u_i[k] = −(G (y_i[k] − y_j[k−p]) + B (v_i[k] − v_j[k−p])),   j the other arm
///
/// v is the estimate of velocity, u is held over a period T and reaches the arm a delay later, and
/// y is measured just before u is written. Everything is linear: rounding and Coulomb friction are
/// left out. Continuous motion is discretised exactly, in two pieces where the delay is not a whole
/// number of periods.
struct SampledLoop {
  std::vector<LinearAxis::Config> arms;  ///< one or two
  double stiffness_N_per_m = 0.0;        ///< G
  double damping_Ns_per_m = 0.0;         ///< B
  VelocityEstimator::Config velocity{};  ///< kinds difference and mean
  double period_s = 1e-3;                ///< T
  int peer_delay_samples = 0;            ///< p
};

/// Whether the loop's estimator is linear, so that the functions below hold for it.
[[nodiscard]] bool is_linear(const SampledLoop& loop);

/// X[k+1] = S X[k]. @pre is_linear(loop), one or two arms.
[[nodiscard]] Eigen::MatrixXd transition(const SampledLoop& loop);

/// Largest |eigenvalue| of the transition; drifts, which are eigenvalues at 1, are left out.
[[nodiscard]] double spectral_radius(const SampledLoop& loop);

/// y/u of an arm at z = e^{jωT}.
[[nodiscard]] std::complex<double> arm_response(const LinearAxis::Config& arm,
                                                double period_s,
                                                double omega_rad_per_s);

/// v/y of the estimator at z = e^{jωT}.
[[nodiscard]] std::complex<double> estimator_response(const SampledLoop& loop,
                                                      double omega_rad_per_s);

}  // namespace teleop
