#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace teleop::testing {

/// Two arms at one pose, linearised, under the sampled position-error law with s = k_f = 1, R = I:
///
///     M q̈ + D q̇ + Jᵀ (K_e J q + D_e J q̇) = a,   τ_amp ȧ = τ − a (a = τ where τ_amp = 0)
///     τ[k] = Jᵀ (G J (q_peer[k−d_p] − q[k−d_o]) + B J (v_peer[k−d_p] − v[k−d_o]))
///
/// with v the filtered first difference of the loop and τ held over the period. Any number of
/// joints; 1 with J = 1 is a mass on a line.
struct SampledPair {
  struct Side {
    Eigen::MatrixXd M;       ///< kg m²
    Eigen::MatrixXd D;       ///< N m s
    double K_e_N_per_m = 0;  ///< what the tool touches
    double D_e_Ns_per_m = 0;
  };
  std::array<Side, 2> side;
  Eigen::MatrixXd J;
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  double cutoff_Hz = 300.0;
  int own_delay = 0;   ///< samples
  int peer_delay = 1;  ///< samples
  double amplifier_lag_s = 0.0;
  double period_s = 1e-3;

  /// x[k+1] = S x[k], exact for inputs held over a period.
  [[nodiscard]] Eigen::MatrixXd transition() const;

  /// Largest |eigenvalue|, the drift of a free pair (at 1) left out.
  [[nodiscard]] double radius() const;
};

/// The smallest stiffness at which the pair is no longer stable, others as they are; 0 when it is
/// not even at `from`.
[[nodiscard]] double marginal_stiffness(SampledPair pair, double from = 20.0);

// ---------------------------------------------------------------------------------------------

/// State of a side: q, q̇, amplifier (if it lags), q of the sample before, filtered v, then the
/// outputs (q, v) of the last samples, newest first.
inline Eigen::MatrixXd SampledPair::transition() const {
  const Eigen::Index n = J.rows();
  const Eigen::Index amplifier = amplifier_lag_s > 0.0 ? n : 0;
  const Eigen::Index moving = 2 * n + amplifier;
  const Eigen::Index own_states = moving + 2 * n;
  const Eigen::Index delays = std::max(own_delay, peer_delay);
  const Eigen::Index size = own_states + 2 * n * delays;
  const double alpha = 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff_Hz * period_s);
  const auto eye = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd JJ = J.transpose() * J;

  Eigen::MatrixXd output = Eigen::MatrixXd::Zero(2 * n, own_states);
  output.block(0, 0, n, n) = eye;
  output.block(n, 0, n, n) = alpha / period_s * eye;
  output.block(n, moving, n, n) = -alpha / period_s * eye;
  output.block(n, moving + n, n, n) = (1.0 - alpha) * eye;
  Eigen::MatrixXd gain(n, 2 * n);
  gain << stiffness_N_per_m * JJ, damping_Ns_per_m * JJ;

  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Side& s = side.at(static_cast<std::size_t>(i));
    const Eigen::Index at = i * size;
    // The command as a function of the whole state.
    Eigen::MatrixXd tau = Eigen::MatrixXd::Zero(n, 2 * size);
    const auto feel = [&](Eigen::Index from, int delay, double sign) {
      if (delay == 0) {
        tau.middleCols(from, own_states) += sign * gain * output;
      } else {
        tau.middleCols(from + own_states + 2 * n * (delay - 1), 2 * n) += sign * gain;
      }
    };
    feel(at, own_delay, -1.0);
    feel(size - at, peer_delay, 1.0);

    // Continuous motion with the command as a constant extra state, then exponential.
    const Eigen::MatrixXd Minv = s.M.inverse();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(moving + n, moving + n);
    A.block(0, n, n, n) = eye;
    A.block(n, 0, n, n) = -Minv * s.K_e_N_per_m * JJ;
    A.block(n, n, n, n) = -Minv * (s.D + s.D_e_Ns_per_m * JJ);
    A.block(n, 2 * n, n, n) = Minv;
    if (amplifier > 0) {
      A.block(2 * n, 2 * n, n, n) = -eye / amplifier_lag_s;
      A.block(2 * n, 3 * n, n, n) = eye / amplifier_lag_s;
    }
    const Eigen::MatrixXd E = (A * period_s).exp();
    S.block(at, at, moving, moving) += E.topLeftCorner(moving, moving);
    S.middleRows(at, moving) += E.block(0, moving, moving, n) * tau;
    S.block(at + moving, at, n, n) = eye;
    S.block(at + moving + n, at, n, own_states) = output.bottomRows(n);
    if (delays > 0) S.block(at + own_states, at, 2 * n, own_states) = output;
    const Eigen::Index older = 2 * n * (delays - 1);
    if (delays > 1) {
      S.block(at + own_states + 2 * n, at + own_states, older, older).setIdentity();
    }
  }
  return S;
}

inline double SampledPair::radius() const {
  const Eigen::VectorXcd roots = transition().eigenvalues();
  double largest = 0.0;
  for (const std::complex<double>& root : roots) {
    const bool drift = std::abs(root - 1.0) < 1e-7;
    if (!drift) largest = std::max(largest, std::abs(root));
  }
  return largest;
}

inline double marginal_stiffness(SampledPair pair, double from) {
  const auto stable = [&](double stiffness) {
    pair.stiffness_N_per_m = stiffness;
    return pair.radius() < 1.0;
  };
  double low = from;
  if (!stable(low)) return 0.0;
  double high = 1.2 * low;
  while (stable(high) && high < 1e6) {
    low = high;
    high *= 1.2;
  }
  while (high - low > 1e-5 * low) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace teleop::testing
