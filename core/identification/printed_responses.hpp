#pragma once

#include <array>
#include <initializer_list>

#include "core/identification/transfer_function.hpp"

namespace teleop {

/// The transfer functions of a PHANToM 1.5 as printed in [Cavusoglu 2002, section 4.3.2], axes x,
/// y, z. The paper does not state the unit of displacement per force; mm/N is presumed, and even
/// then they are too light by 3.3 to 4.6. They are data to draw and to compare with, not plants:
/// free polynomials that violate the structure of the mechanism, x and y not passive, so that no
/// wall at all is stable on them (docs/theory.md).
[[nodiscard]] inline std::array<TransferFunction, 3> printed_responses() {
  const auto polynomial = [](std::initializer_list<double> coefficients) {
    Eigen::VectorXd result{static_cast<Eigen::Index>(coefficients.size())};
    Eigen::Index i = 0;
    for (const double c : coefficients) {
      result(i++) = c;
    }
    return result;
  };
  return {{{.numerator = polynomial({1.0, 5.716, 9.201e4}),
            .denominator = polynomial({3.329e-6, 0.001226, 1.536})},
           {.numerator = polynomial({1.0, 30.25, 2.923e5, 5.741e6, 1.784e10}),
            .denominator = polynomial({1.526, 233.0, 2.848e5})},
           {.numerator = polynomial({1.0, 1248.0, 1.275e6, 3.243e8, 1.097e11}),
            .denominator = polynomial({5.953, 875.3, 9.635e5})}}};
}

}  // namespace teleop
