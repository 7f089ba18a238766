#pragma once

#include <cmath>

#include <Eigen/Core>

namespace teleop {

/// exp(A) by scaling and squaring of a Taylor polynomial of degree 14: A is halved until its norm
/// is below ½, where the polynomial errs by less than 1e-16 [Moler 2003, methods 1 and 3]. Give A
/// in units that keep its entries of like size; each halving costs about half a bit.
/// @pre finite. Loop: allocation-free for matrices of fixed size, noexcept, at most 60 squarings.
template <class Matrix>
[[nodiscard]] Matrix matrix_exponential(const Matrix& A) noexcept {
  const double norm = A.cwiseAbs().rowwise().sum().maxCoeff();
  int halvings = 0;
  while (halvings < 60 && std::ldexp(norm, -halvings) > 0.5) {
    ++halvings;
  }
  const Matrix B = A * std::ldexp(1.0, -halvings);
  const Matrix eye = Matrix::Identity(A.rows(), A.cols());
  constexpr int kDegree = 14;
  Matrix sum = eye;
  Matrix product = eye;
  for (int k = kDegree; k > 0; --k) {
    product.noalias() = B * sum;
    sum = eye + product / k;
  }
  for (int k = 0; k < halvings; ++k) {
    product.noalias() = sum * sum;
    sum = product;
  }
  return sum;
}

}  // namespace teleop
