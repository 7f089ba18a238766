#include "core/identification/linear_model.hpp"

#include <complex>
#include <numbers>

#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// The amplifier f' = (u − f)/τ as one more state in front of the system.
LinearModel behind_lag(const LinearModel& model, double lag_s, bool is_derivative) {
  const Eigen::Index n = model.A.rows();
  LinearModel result{.A = Eigen::MatrixXd::Zero(n + 1, n + 1),
                     .B = Eigen::VectorXd::Zero(n + 1),
                     .C = Eigen::RowVectorXd::Zero(n + 1),
                     .D = 0.0};
  result.A.topLeftCorner(n, n) = model.A;
  result.A.topRightCorner(n, 1) = model.B;
  result.C.head(n) = model.C;
  result.C(n) = model.D;
  if (!is_derivative) {
    result.A(n, n) = -1.0 / lag_s;
    result.B(n) = 1.0 / lag_s;
  }
  return result;
}

Eigen::MatrixXd with_input(const LinearModel& model) {
  const Eigen::Index n = model.A.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n + 1, n + 1);
  result.topLeftCorner(n, n) = model.A;
  result.topRightCorner(n, 1) = model.B;
  return result;
}

}  // namespace

ComplexResponse sampled_response(const Linearised& system,
                                 const Sampling& sampling,
                                 const Eigen::VectorXd& frequency_Hz) {
  const bool lags = sampling.amplifier_lag_s > 0.0;
  const auto seen = [&](const LinearModel& model, bool is_derivative) {
    return lags ? behind_lag(model, sampling.amplifier_lag_s, is_derivative) : model;
  };
  const LinearModel model = seen(system.model, false);
  const Eigen::Index n = model.A.rows();
  const Eigen::MatrixXd M = with_input(model) * sampling.period_s;
  const Eigen::MatrixXd E = M.exp();

  const auto parameters = static_cast<Eigen::Index>(system.derivatives.size());
  std::vector<LinearModel> derivatives;
  std::vector<Eigen::MatrixXd> d_E;
  for (const LinearModel& derivative : system.derivatives) {
    derivatives.push_back(seen(derivative, true));
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(2 * n + 2, 2 * n + 2);
    block.topLeftCorner(n + 1, n + 1) = M;
    block.bottomRightCorner(n + 1, n + 1) = M;
    block.topRightCorner(n + 1, n + 1) = with_input(derivatives.back()) * sampling.period_s;
    const Eigen::MatrixXd exponential = block.exp();
    d_E.emplace_back(exponential.topRightCorner(n + 1, n + 1));
  }

  ComplexResponse response{.value = Eigen::VectorXcd::Zero(frequency_Hz.size()),
                           .derivative = Eigen::MatrixXcd::Zero(frequency_Hz.size(), parameters)};
  for (Eigen::Index i = 0; i < frequency_Hz.size(); ++i) {
    const double turn = kTwoPi * frequency_Hz(i) * sampling.period_s;
    const Complex z = std::polar(1.0, turn);
    const Complex late = std::polar(1.0, -turn * sampling.delay_samples);
    Eigen::MatrixXcd resolvent = -E.topLeftCorner(n, n).cast<Complex>();
    resolvent.diagonal().array() += z;
    const Eigen::PartialPivLU<Eigen::MatrixXcd> lu{resolvent};
    const Eigen::VectorXcd x = lu.solve(E.topRightCorner(n, 1).cast<Complex>().eval());
    const Eigen::VectorXcd seen_from = model.C.transpose().cast<Complex>();
    const Eigen::VectorXcd w = lu.transpose().solve(seen_from);
    response.value(i) = late * ((model.C.cast<Complex>() * x)(0) + model.D / z);
    for (Eigen::Index k = 0; k < parameters; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Eigen::VectorXcd driven = d_E[at].topRightCorner(n, 1).cast<Complex>() +
                                      d_E[at].topLeftCorner(n, n).cast<Complex>() * x;
      const Complex through = (derivatives[at].C.cast<Complex>() * x)(0) + derivatives[at].D / z;
      response.derivative(i, k) = late * (w.cwiseProduct(driven).sum() + through);
    }
  }
  return response;
}

Eigen::VectorXcd continuous_response(const LinearModel& model,
                                     const Eigen::VectorXd& frequency_Hz) {
  Eigen::VectorXcd response{frequency_Hz.size()};
  for (Eigen::Index i = 0; i < frequency_Hz.size(); ++i) {
    Eigen::MatrixXcd resolvent = -model.A.cast<Complex>();
    resolvent.diagonal().array() += Complex{0.0, kTwoPi * frequency_Hz(i)};
    const Eigen::VectorXcd x =
        Eigen::PartialPivLU<Eigen::MatrixXcd>{resolvent}.solve(model.B.cast<Complex>().eval());
    response(i) = (model.C.cast<Complex>() * x)(0) + model.D;
  }
  return response;
}

Eigen::VectorXcd hold_response(const Sampling& sampling, const Eigen::VectorXd& frequency_Hz) {
  Eigen::VectorXcd response{frequency_Hz.size()};
  for (Eigen::Index i = 0; i < frequency_Hz.size(); ++i) {
    const Complex s{0.0, kTwoPi * frequency_Hz(i)};
    response(i) = std::exp(-s * (sampling.delay_samples * sampling.period_s)) *
                  (1.0 - std::exp(-s * sampling.period_s)) /
                  (s * sampling.period_s * (1.0 + s * sampling.amplifier_lag_s));
  }
  return response;
}

}  // namespace teleop
