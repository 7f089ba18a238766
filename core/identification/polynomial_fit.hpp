#pragma once

#include "core/identification/response_fit.hpp"
#include "core/identification/transfer_function.hpp"

namespace teleop {

/// Degrees of P(s) = N(s) / (s² D(s)).
struct PolynomialOrder {
  int numerator = 2;
  int denominator = 2;
};

struct PolynomialFit {
  PolynomialOrder order;
  TransferFunction P;          ///< numerator monic, as the paper prints them
  TransferFunction deviation;  ///< standard deviation of each coefficient of P
  Passivity passivity;
  ResponseFit fit;
};

/// Free polynomials for comparison, as [Cavusoglu 2002, section 4.3.2] fitted them: nothing holds
/// the coefficients to a mechanism, so the result may be active. Starting values by the iteration
/// of [Sanathanan 1963], then maximum likelihood like every other fit.
/// @pre 1 ≤ order.numerator ≤ order.denominator + 2.
[[nodiscard]] PolynomialFit fit_polynomial(const PolynomialOrder& order,
                                           const MeasuredResponse& data,
                                           const Sampling& sampling);

}  // namespace teleop
