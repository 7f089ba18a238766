#include "core/identification/polynomial_fit.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/QR>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// θ = numerator, then denominator without its leading one; highest powers first.
TransferFunction unpack(const PolynomialOrder& order, const Eigen::VectorXd& theta) {
  TransferFunction P{.numerator = theta.head(order.numerator + 1),
                     .denominator = Eigen::VectorXd::Ones(order.denominator + 1)};
  P.denominator.tail(order.denominator) = theta.tail(order.denominator);
  return P;
}

Linearised linearised(const PolynomialOrder& order, const Eigen::VectorXd& theta) {
  const TransferFunction P = unpack(order, theta);
  Linearised system{.model = realisation(P), .derivatives = {}};
  const LinearModel& model = system.model;
  const Eigen::Index n = model.A.rows();
  const LinearModel zero{.A = Eigen::MatrixXd::Zero(n, n),
                         .B = Eigen::VectorXd::Zero(n),
                         .C = Eigen::RowVectorXd::Zero(n),
                         .D = 0.0};
  for (Eigen::Index i = 0; i <= order.numerator; ++i) {
    LinearModel derivative = zero;
    const Eigen::Index state = n - 1 - order.numerator + i;
    if (state < 0) {
      derivative.C = model.A.row(0);
      derivative.D = 1.0;
    } else {
      derivative.C(state) = 1.0;
    }
    system.derivatives.push_back(derivative);
  }
  for (Eigen::Index i = 0; i < order.denominator; ++i) {
    LinearModel derivative = zero;
    derivative.A(0, i) = -1.0;
    derivative.C(i) = -model.D;
    system.derivatives.push_back(derivative);
  }
  return system;
}

/// Minimises Σ |(N − P s² D)/(σ s² D')|² with D' from the round before. Everything in units of
/// `omega_0`.
Eigen::VectorXd sanathanan_koerner(const PolynomialOrder& order,
                                   const MeasuredResponse& data,
                                   const Eigen::VectorXcd& P,
                                   double omega_0) {
  constexpr int kRounds = 20;
  const Eigen::Index lines = P.size();
  const Eigen::Index unknowns = order.numerator + 1 + order.denominator;
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(unknowns);
  Eigen::VectorXcd previous = Eigen::VectorXcd::Ones(lines);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXcd columns{lines, unknowns};
    Eigen::VectorXcd right{lines};
    for (Eigen::Index i = 0; i < lines; ++i) {
      const Complex s{0.0, kTwoPi * data.frequency_Hz(i) / omega_0};
      const Complex weight = 1.0 / (data.deviation(i) * s * s * previous(i));
      Complex power = weight;
      for (Eigen::Index k = order.numerator; k >= 0; --k) {
        columns(i, k) = power;
        power *= s;
      }
      power = -weight * P(i) * s * s;
      for (Eigen::Index k = unknowns - 1; k > order.numerator; --k) {
        columns(i, k) = power;
        power *= s;
      }
      right(i) = -power;
    }
    Eigen::MatrixXd A{2 * lines, unknowns};
    A << columns.real(), columns.imag();
    Eigen::VectorXd y{2 * lines};
    y << right.real(), right.imag();
    theta = A.colPivHouseholderQr().solve(y);
    for (Eigen::Index i = 0; i < lines; ++i) {
      const Complex s{0.0, kTwoPi * data.frequency_Hz(i) / omega_0};
      Complex D = 1.0;
      for (Eigen::Index k = 0; k < order.denominator; ++k) {
        D = D * s + theta(order.numerator + 1 + k);
      }
      previous(i) = D;
    }
  }
  return theta;
}

/// From θ in units of ω0 to a monic numerator in SI, with deviations.
void to_printed_form(PolynomialFit& result, double omega_0) {
  const PolynomialOrder& order = result.order;
  const Eigen::VectorXd& theta = result.fit.theta;
  const TransferFunction scaled = unpack(order, theta);
  result.P = scaled;
  result.deviation = scaled;
  const double lead = theta(0);
  const auto convert = [&](Eigen::VectorXd& value, Eigen::VectorXd& deviation, Eigen::Index offset,
                           int power) {
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      const double unit = std::pow(omega_0, power + static_cast<int>(i));
      const Eigen::Index at = offset + i;  // of the coefficient in θ; the leading one is not there
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(theta.size());
      gradient(0) = -value(i) / (lead * lead);
      if (offset == 0 || i > 0) gradient(at) += 1.0 / lead;
      deviation(i) = unit * std::sqrt(gradient.dot(result.fit.covariance * gradient));
      value(i) *= unit / lead;
    }
  };
  convert(result.P.numerator, result.deviation.numerator, 0, 0);
  // P = N(s/ω0) / ((s/ω0)² D(s/ω0)), multiplied out by ω0^numerator order.
  convert(result.P.denominator, result.deviation.denominator, order.numerator,
          order.numerator - order.denominator - 2);
}

}  // namespace

PolynomialFit fit_polynomial(const PolynomialOrder& order,
                             const MeasuredResponse& data,
                             const Sampling& sampling) {
  expects(order.numerator >= 1 && order.numerator <= order.denominator + 2, "P(s) is proper");
  // Times the geometric mean of the frequencies, so that all coefficients are of one size.
  const double omega_0 = kTwoPi * std::exp(data.frequency_Hz.array().log().mean());
  Sampling scaled = sampling;
  scaled.period_s *= omega_0;
  scaled.amplifier_lag_s *= omega_0;
  MeasuredResponse slow = data;
  slow.frequency_Hz /= omega_0;

  const Eigen::VectorXcd P = data.value.cwiseQuotient(hold_response(sampling, data.frequency_Hz));
  const Eigen::VectorXd start = sanathanan_koerner(order, data, P, omega_0);
  PolynomialFit result{.order = order, .P = {}, .deviation = {}, .passivity = {}, .fit = {}};
  result.fit =
      fit_response([&order](const Eigen::VectorXd& theta) { return linearised(order, theta); },
                   start, slow, scaled);
  to_printed_form(result, omega_0);
  result.passivity = passivity(result.P);
  return result;
}

}  // namespace teleop
