#include "core/tuning/experiment.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace teleop {

/// The finest of the joints that move this axis alone would be too hopeful: their steps add.
double ToolFrame::quantum_m(Eigen::Index axis) const noexcept {
  const JointVector step = 2.0 * std::numbers::pi * counts_per_rev.cwiseInverse();
  return J.row(axis).transpose().cwiseProduct(step).norm();
}

}  // namespace teleop
