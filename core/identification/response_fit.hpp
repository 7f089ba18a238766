#pragma once

#include <functional>

#include <Eigen/Core>

#include "core/identification/linear_model.hpp"

namespace teleop {

/// A sampled frequency response with its uncertainty.
struct MeasuredResponse {
  Eigen::VectorXd frequency_Hz;
  Eigen::VectorXcd value;     ///< y_k over u_k, m/N
  Eigen::VectorXd deviation;  ///< √E|error|², real and imaginary part together, m/N
};

/// A system at parameters θ, with derivatives by θ.
using ModelFamily = std::function<Linearised(const Eigen::VectorXd& theta)>;

/// What a fit says.
struct ResponseFit {
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
  double cost = 0.0;   ///< Σ |r|², expected: twice the lines less the parameters
  double error = 0.0;  ///< √(cost / expected cost): 1 when the model leaves nothing but noise
};

/// Maximum likelihood for circular Gaussian errors of known variance [Pintelon 2012, section 9.11]:
///
///     minimise Σ |r_k|²,   r_k = √2 (G(θ, f_k) − G_k) / σ_k
///
/// by Levenberg–Marquardt with exact derivatives. The covariance is the inverse of the Fisher
/// information ½ Σ ∂|r|²; where the model leaves more than the noise (error > 1) it is widened by
/// error². Thread: any; not for the loop.
/// @pre two lines a parameter at least.
[[nodiscard]] ResponseFit fit_response(const ModelFamily& family,
                                       const Eigen::VectorXd& start,
                                       const MeasuredResponse& data,
                                       const Sampling& sampling);

}  // namespace teleop
