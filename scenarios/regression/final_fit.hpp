#pragma once

#include <vector>

#include <Eigen/Core>

#include "scenarios/regression/design.hpp"
#include "scenarios/regression/model_choice.hpp"

namespace teleop {

/// The chosen forms on all rows, shapes refined between the points of their grids.
struct FinalFit {
  struct Effect {
    const Regressor* regressor = nullptr;
    std::size_t axis = 0;
    Regressor::Estimate estimate{};
  };
  std::vector<Effect> effects{};
  Eigen::MatrixXd columns{};    ///< rigid body, then the effects
  Eigen::MatrixXd inverse{};    ///< covariance of the coefficients
  Eigen::VectorXd residuals{};  ///< N m
  Eigen::VectorXd weights{};    ///< of the rows, 1/(N m)²
};

[[nodiscard]] FinalFit final_fit(const Design& design,
                                 const ModelChoice& choice,
                                 Counting counting);

/// What a column would still explain of the residuals, χ² of one degree.
[[nodiscard]] double gain_of(const FinalFit& fit, const Eigen::VectorXd& column);

}  // namespace teleop
