#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tuning/analytic_margin.hpp"
#include "core/tuning/experiment.hpp"
#include "core/tuning/pose_move.hpp"

namespace teleop {

/// The theoretical limit of a simulated arm at a pose: one rigid body seen along the tool axis, the
/// other axes free,
///
///     m = 1 / (eᵀ J M⁻¹ Jᵀ e),   b = m² eᵀ J M⁻¹ D M⁻¹ Jᵀ e,
///
/// D the viscous friction of the joints and 4 F_c/(π q̇_A) for each one's Coulomb friction, which is
/// what an oscillation of amplitude A feels of it (describing function). Delay of the drive
/// included, every other effect of the plant left out. Absent for arms that are not simulated and
/// estimators that are not linear.
struct TheoryAsk {
  std::vector<std::string> devices;  ///< one, or master and slave
  JointVector q = JointVector::Zero();
  ExperimentConfig experiment{};
  double amplitude_m = 3e-4;
  double period_s = 1e-3;
};
[[nodiscard]] std::optional<AnalyticMargin> theory_of(const TheoryAsk& ask);

}  // namespace teleop
