#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/settings.hpp"
#include "core/diagnosis/likelihood.hpp"

namespace teleop {

/// A parameter of an effect that a fit may change.
struct FreeParameter {
  std::size_t effect = 0;  ///< in MachineModel::effects
  std::string name{};
  bool logarithmic = false;  ///< searched by its logarithm
  double step = 0.0;         ///< of derivatives, in the searched coordinate
  Range range{};
};

/// Every fitted parameter of the effects; one whose role is on_evidence where it is given.
[[nodiscard]] std::vector<FreeParameter> free_parameters(const std::vector<EffectSpec>& effects);

/// The values of free parameters of a model, in the coordinates in which they are searched.
[[nodiscard]] Eigen::VectorXd coordinates_of(const MachineModel& model,
                                             const std::vector<FreeParameter>& free);

/// What the rigid body's departures do to the errors of each run, a column each.
using BaseColumns = std::vector<Eigen::MatrixXf>;
[[nodiscard]] BaseColumns base_columns(const Likelihood& likelihood, const MachineModel& model);

/// A model with parameters at their most probable values.
struct Fit {
  MachineModel model{};
  std::vector<FreeParameter> free{};
  double chi2 = 0.0;                      ///< Σ |w|² + |z|²
  double volume = 0.0;                    ///< Σ log det S: chi2 + volume is what is least
  Eigen::MatrixXd information{};          ///< of (free parameters, base), prior included
  Eigen::MatrixXd scatter{};              ///< of the gradient, from stretch to stretch of time
  std::vector<Eigen::VectorXf> errors{};  ///< of each run
  std::vector<Eigen::MatrixXf> slopes{};  ///< of the errors by (free parameters, base)
  bool converged = false;

  /// Standard errors of the free parameters in the searched coordinates: from the curvature of the
  /// likelihood, or from the scatter of its gradient (sandwich) where that says more, as it does
  /// where errors hang together.
  [[nodiscard]] Eigen::VectorXd deviations() const;

  /// The model with the parameters that the other runs ask for, to first order.
  [[nodiscard]] MachineModel left_out_model(std::size_t run) const;

  /// Errors of a run under the parameters that the other runs ask for, to first order.
  [[nodiscard]] Eigen::VectorXf left_out_errors(std::size_t run) const;

  /// Σ |w|² of all runs so.
  [[nodiscard]] double left_out() const;

 private:
  /// By which (free parameters, base) move when a run is left out.
  [[nodiscard]] Eigen::VectorXd left_out_move(std::size_t run) const;
};

struct FitOptions {
  int iterations = 15;
  bool slopes = true;  ///< at the end, by central differences; else errors alone
};

/// Levenberg–Marquardt from the given model (Ceres); the rigid body's departures enter linearly
/// through `base`, columns at a model near by. Where drives move apart from their links the
/// innovations' volume depends on the parameters too. Derivatives are differences of simulations.
[[nodiscard]] Fit fit(const Likelihood& likelihood,
                      const BaseColumns& base,
                      const MachineModel& start,
                      const FitOptions& options = {});

}  // namespace teleop
