#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/diagnosis/recording.hpp"
#include "core/diagnosis/tether.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// What a small torque on the drives, held over each sample, does to the whitened innovations of a
/// tethered simulation, to first order: the linear model of Tether run with its own gains.
/// @param torque N m at each row
/// @param skip rows at the start that do not count
[[nodiscard]] Eigen::VectorXf torque_response(const Tether& tether,
                                              const std::vector<JointMatrix>& mobility,
                                              double period_s,
                                              const std::vector<JointVector>& torque,
                                              std::size_t skip);

}  // namespace teleop
