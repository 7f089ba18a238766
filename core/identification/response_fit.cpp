#include "core/identification/response_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/NonLinearOptimization>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

/// The residuals in the shape that Eigen's solver asks for.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  // NOLINTBEGIN(readability-identifier-naming): Eigen asks for these names
  static constexpr int InputsAtCompileTime = Eigen::Dynamic;
  static constexpr int ValuesAtCompileTime = Eigen::Dynamic;
  // NOLINTEND(readability-identifier-naming)

  const ModelFamily& family;
  const MeasuredResponse& data;
  const Sampling& sampling;
  Eigen::Index parameters = 0;

  [[nodiscard]] int inputs() const { return static_cast<int>(parameters); }
  [[nodiscard]] int values() const { return static_cast<int>(2 * data.value.size()); }

  int operator()(const Eigen::VectorXd& theta, Eigen::VectorXd& residual) const {
    Linearised system = family(theta);
    system.derivatives.clear();
    const ComplexResponse model = sampled_response(system, sampling, data.frequency_Hz);
    const Eigen::VectorXcd difference = weight().cwiseProduct(model.value - data.value);
    residual << difference.real(), difference.imag();
    // A step to where the model cannot be computed must look like a bad one.
    if (!residual.allFinite()) residual.setConstant(kBad);
    return 0;
  }

  int df(const Eigen::VectorXd& theta, Eigen::MatrixXd& jacobian) const {
    const ComplexResponse model = sampled_response(family(theta), sampling, data.frequency_Hz);
    const Eigen::MatrixXcd weighted = weight().asDiagonal() * model.derivative;
    jacobian << weighted.real(), weighted.imag();
    if (!jacobian.allFinite()) jacobian.setZero();
    return 0;
  }

  [[nodiscard]] Eigen::VectorXd weight() const {
    return std::numbers::sqrt2 * data.deviation.cwiseInverse();
  }

  static constexpr double kBad = 1e12;
};

/// Inverse of JᵀJ; a direction that the data say nothing about gets a huge variance, not infinity.
Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd size = jacobian.colwise().norm().cwiseMax(1e-12);
  const Eigen::MatrixXd scaled = jacobian * size.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{scaled.transpose() * scaled};
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-13);
  const Eigen::MatrixXd turned = size.cwiseInverse().asDiagonal() * eigen.eigenvectors();
  return turned * values.cwiseInverse().asDiagonal() * turned.transpose();
}

}  // namespace

ResponseFit fit_response(const ModelFamily& family,
                         const Eigen::VectorXd& start,
                         const MeasuredResponse& data,
                         const Sampling& sampling) {
  expects(data.value.size() == data.frequency_Hz.size() &&
              data.deviation.size() == data.frequency_Hz.size() &&
              data.value.size() >= 2 * start.size(),
          "two lines a parameter at least");
  Residuals residuals{
      .family = family, .data = data, .sampling = sampling, .parameters = start.size()};
  Eigen::LevenbergMarquardt<Residuals> solver{residuals};
  solver.parameters.maxfev = 300;
  solver.parameters.xtol = 1e-10;
  solver.parameters.ftol = 1e-12;
  ResponseFit fit{.theta = start, .covariance = {}, .cost = 0.0, .error = 0.0};
  solver.minimize(fit.theta);

  Eigen::VectorXd residual{residuals.values()};
  Eigen::MatrixXd jacobian{residuals.values(), residuals.inputs()};
  residuals(fit.theta, residual);
  residuals.df(fit.theta, jacobian);
  fit.cost = residual.squaredNorm();
  fit.error = std::sqrt(fit.cost / static_cast<double>(residuals.values() - residuals.inputs()));
  const double widening = std::max(1.0, fit.error);
  fit.covariance = widening * widening * inverse_information(jacobian);
  return fit;
}

}  // namespace teleop
