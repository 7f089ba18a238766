#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/arm_model.hpp"
#include "scenarios/regression/smooth.hpp"

namespace teleop {

/// One effect as a regression has it: torques that add to those commanded,
///
///     M q̈ + C q̇ + N − τ = Σ coefficient · column(q, q̇, q̈, τ; shape),
///
/// linear in the coefficients; what is not linear is the shape, tried on a grid.
struct Regressor {
  struct Place {
    const ArmModel& arm;
    std::size_t axis = 0;  ///< of an effect of one axis
    double shape = 0.0;
  };
  /// What a fit came to, with standard errors.
  struct Estimate {
    std::vector<double> coefficients{};
    std::vector<double> deviations{};
    double shape = 0.0;
    double shape_deviation = 0.0;  ///< 0: the shape is not fitted
  };
  struct Parameter {
    std::string_view name{};
    double value = 0.0;
    double deviation = 0.0;
  };
  /// What the grid of an axis may depend on.
  struct Use {
    double ratio = 1.0;            ///< motor turns a joint turn
    double torque_peak = 0.0;      ///< N m
    std::vector<double> angles{};  ///< rad, sorted
  };

  std::string_view kind{};
  bool per_axis = true;
  bool continuous = false;  ///< the shape is refined between the points of the grid
  std::vector<double> (*grid)(const Use& use) = nullptr;
  std::vector<Signal> (*columns)(const SmoothRun& run, const Place& place) = nullptr;
  /// Nothing when no such effect has these coefficients.
  std::optional<std::vector<Parameter>> (*parameters)(const Estimate& fit,
                                                      const Place& place) = nullptr;
};

/// The vocabulary, as far as a regression can have it.
[[nodiscard]] std::span<const Regressor> regressors();

/// Torques that nothing in the vocabulary makes: what they still explain is left over.
[[nodiscard]] std::span<const Regressor> leftover_probes();

/// The nominal inverse dynamics of a run.
[[nodiscard]] Signal inverse_dynamics(const ArmModel& arm, const SmoothRun& run);

}  // namespace teleop
