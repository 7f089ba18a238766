#include "core/identification/transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Complex value(const Eigen::VectorXd& polynomial, Complex s) {
  Complex sum = 0.0;
  for (Eigen::Index i = 0; i < polynomial.size(); ++i) {
    sum = sum * s + polynomial(i);
  }
  return sum;
}

/// Roots other than zero, as eigenvalues of the companion matrix.
Eigen::VectorXcd roots(const Eigen::VectorXd& polynomial) {
  Eigen::Index first = 0;
  Eigen::Index last = polynomial.size() - 1;
  while (first < last && polynomial(first) == 0.0) {
    ++first;
  }
  while (last > first && polynomial(last) == 0.0) {
    --last;
  }
  const Eigen::Index n = last - first;
  if (n < 1) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.row(0) = -polynomial.segment(first + 1, n).transpose() / polynomial(first);
  companion.bottomLeftCorner(n - 1, n - 1).setIdentity();
  return companion.eigenvalues();
}

/// Coefficients of (jω)^i with the powers of j carried out: polynomial in ω.
Eigen::VectorXcd along_the_axis(const Eigen::VectorXd& polynomial, bool conjugate) {
  Eigen::VectorXcd result = polynomial.cast<Complex>();
  Complex power = 1.0;
  for (Eigen::Index i = polynomial.size() - 1; i >= 0; --i) {
    result(i) *= power;
    power *= Complex{0.0, conjugate ? -1.0 : 1.0};
  }
  return result;
}

/// Re{N(jω) conj(jω D(jω))}, by powers of ω², highest first. Frequencies in units of `scale`.
Eigen::VectorXd real_part(const TransferFunction& P, double scale) {
  const auto scaled = [scale](Eigen::VectorXd polynomial) {
    double power = 1.0;
    for (Eigen::Index i = polynomial.size() - 1; i >= 0; --i) {
      polynomial(i) *= power;
      power *= scale;
    }
    return polynomial;
  };
  Eigen::VectorXd s_D{P.denominator.size() + 1};
  s_D << scaled(P.denominator), 0.0;
  const Eigen::VectorXcd top = along_the_axis(scaled(P.numerator), false);
  const Eigen::VectorXcd bottom = along_the_axis(s_D, true);
  Eigen::VectorXcd product = Eigen::VectorXcd::Zero(top.size() + bottom.size() - 1);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(product.size());
  for (Eigen::Index i = 0; i < top.size(); ++i) {
    product.segment(i, bottom.size()) += top(i) * bottom;
    size.segment(i, bottom.size()) += std::abs(top(i)) * bottom.cwiseAbs();
  }
  // In a mechanism most terms cancel: what rounding leaves of them is not power.
  product = (product.cwiseAbs().array() > 1e-12 * size.array()).select(product, 0.0);
  // Odd powers of ω are imaginary; ω⁰ is absent because of the factor jω.
  const Eigen::Index degree = product.size() - 1;
  Eigen::VectorXd even{degree / 2 + 1};
  for (Eigen::Index power = 0; power < even.size(); ++power) {
    even(even.size() - 1 - power) = product(degree - 2 * power).real();
  }
  return even;
}

}  // namespace

std::complex<double> response(const TransferFunction& P, double frequency_Hz) {
  const Complex s{0.0, kTwoPi * frequency_Hz};
  return value(P.numerator, s) / (s * s * value(P.denominator, s));
}

LinearModel realisation(const TransferFunction& P) {
  const Eigen::Index n = P.denominator.size() + 1;
  expects(P.numerator.size() <= n + 1 && P.denominator(0) != 0.0, "P(s) is proper");
  Eigen::VectorXd a = Eigen::VectorXd::Zero(n);  // monic denominator without its leading one
  a.head(n - 2) = P.denominator.tail(n - 2) / P.denominator(0);
  Eigen::VectorXd c = Eigen::VectorXd::Zero(n + 1);
  c.tail(P.numerator.size()) = P.numerator / P.denominator(0);
  LinearModel model{.A = Eigen::MatrixXd::Zero(n, n),
                    .B = Eigen::VectorXd::Unit(n, 0),
                    .C = (c.tail(n) - c(0) * a).transpose(),
                    .D = c(0)};
  model.A.row(0) = -a.transpose();
  model.A.bottomLeftCorner(n - 1, n - 1).setIdentity();
  return model;
}

Passivity passivity(const TransferFunction& P) {
  Passivity result;
  const Eigen::VectorXcd poles = roots(P.denominator);
  result.stable = poles.size() == P.denominator.size() - 1 &&
                  (poles.size() == 0 || poles.real().maxCoeff() < 0.0);
  const double scale = poles.size() == 0 ? 1.0 : std::max(poles.cwiseAbs().maxCoeff(), 1e-300);
  const Eigen::VectorXd sign = real_part(P, scale);

  std::vector<double> edges{0.0};
  const Eigen::VectorXcd changes = roots(sign);
  for (const Complex& x : changes) {
    if (x.real() > 0.0 && std::abs(x.imag()) <= 1e-9 * std::abs(x)) {
      edges.push_back(std::sqrt(x.real()));
    }
  }
  std::sort(edges.begin(), edges.end());
  // Rounding makes a zero of the polynomial a little negative: that is no activity.
  const double tiny = 1e-12 * sign.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool last = i + 1 == edges.size();
    const double middle = last ? 2.0 * edges[i] + 1.0 : 0.5 * (edges[i] + edges[i + 1]);
    const Complex here = value(sign, middle * middle);
    if (here.real() >= -tiny) continue;
    const double low = edges[i] * scale / kTwoPi;
    const double high =
        last ? std::numeric_limits<double>::infinity() : edges[i + 1] * scale / kTwoPi;
    if (!result.active_Hz.empty() && result.active_Hz.back().high == low) {
      result.active_Hz.back().high = high;
    } else {
      result.active_Hz.push_back({.low = low, .high = high});
    }
  }
  const double stiffness_sign =
      P.numerator(P.numerator.size() - 1) * P.denominator(P.denominator.size() - 1);
  result.passive = result.stable && stiffness_sign > 0.0 && result.active_Hz.empty();
  return result;
}

}  // namespace teleop
