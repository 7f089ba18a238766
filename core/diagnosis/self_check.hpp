#pragma once

#include <Eigen/Core>

#include "core/diagnosis/search.hpp"

namespace teleop {

/// What the method makes of recordings of a machine that is just what an explanation says.
struct SelfCheck {
  Eigen::VectorXd bias{};  ///< of the free parameters, in their searched coordinates
  double leftover = 0.0;   ///< the largest gain of what seemed to be left over
};

/// Fits replicas of the recordings, made by the explanation itself.
[[nodiscard]] SelfCheck self_check(const Likelihood& likelihood, const Explanation& explanation);

/// Adds biases that stand out of chance to the standard errors. Estimates stay: where the method is
/// biased on its own replicas, it is so on recordings of a device that it only resembles, but not
/// by the same amount.
void widen(SearchResult& found, const SelfCheck& check);

}  // namespace teleop
