#pragma once

#include <complex>
#include <vector>

#include <Eigen/Core>

#include "core/base/settings.hpp"
#include "core/identification/linear_model.hpp"

namespace teleop {

/// P(s) = N(s) / (s² D(s)): force to displacement of a mechanism that is free to move, as the
/// polynomials of [Cavusoglu 2002, section 4.3.2]. Coefficients with the highest power first.
struct TransferFunction {
  Eigen::VectorXd numerator;    ///< N
  Eigen::VectorXd denominator;  ///< D
};

[[nodiscard]] std::complex<double> response(const TransferFunction& P, double frequency_Hz);

/// A state space of it; its states have no meaning of their own.
/// @pre the numerator has at most two powers more than the denominator, whose first is not zero.
[[nodiscard]] LinearModel realisation(const TransferFunction& P);

/// Whether force times velocity can only go in: s P(s) is positive real if and only if D has its
/// roots in the open left half plane, N(0)/D(0) > 0, and Re{jω P(jω)} ≥ 0 at every frequency
/// [Colgate 1997].
struct Passivity {
  bool stable = false;
  std::vector<Range> active_Hz;  ///< where Re{jω P(jω)} < 0; the last may reach to infinity
  bool passive = false;
};

/// Exact: the sign of Re{jω P(jω)} is that of a polynomial in ω², which changes at its roots only.
[[nodiscard]] Passivity passivity(const TransferFunction& P);

}  // namespace teleop
