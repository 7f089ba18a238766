#pragma once

#include <span>
#include <vector>

namespace teleop {

/// One term of a free response: A e^{σ t} cos(ω t + φ).
struct FreeMode {
  double growth_per_s = 0.0;     ///< σ
  double omega_rad_per_s = 0.0;  ///< ω, not negative; 0: the term does not oscillate
};

/// The exponentials that a uniformly sampled free response is made of, by a subspace fit: the
/// Hankel matrix of the record has a signal space of as many dimensions as there are poles, and
/// that space is invariant against a shift by one sample (ESPRIT [Roy 1989]). Directions whose
/// strength does not stand out of white noise of deviation `noise_std` are left out; at most
/// kMostPoles are kept, a pair counting two. A constant appears as a mode with σ ≈ 0, ω = 0.
///
/// Good to start a least-squares fit from (oscillation.hpp), which is what gives the uncertainty.
/// @pre dt_s > 0, at least 8 samples. Thread: any; it allocates, so not for a loop.
[[nodiscard]] std::vector<FreeMode> find_modes(std::span<const double> y,
                                               double dt_s,
                                               double noise_std);

inline constexpr int kMostPoles = 8;

}  // namespace teleop
