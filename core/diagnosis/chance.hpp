#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace teleop {

/// Pulls of quantities on the errors of a model, stretch of time by stretch, and how much each
/// quantity weighs: under a sufficient model (Σ pull)² / weight is about χ² of one degree.
struct Pulls {
  Eigen::MatrixXd by_stretch{};  ///< a row each stretch, a column each quantity
  Eigen::VectorXd weight{};
};

/// Probability that the largest (Σ pull)² / weight of all quantities exceeds `largest` by chance:
/// a wild bootstrap, in which whole stretches change their sign together. Quantities that overlap
/// and errors that are uneven or hang together within a stretch are so allowed for. Beyond what
/// resampling shows the tail is continued as an exponential.
[[nodiscard]] double chance_of(double largest, const Pulls& pulls, std::uint64_t seed);

}  // namespace teleop
