#pragma once

#include <cstddef>
#include <vector>

#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/search.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// How far models go astray when they are left to themselves for a quarter of a second at a time,
/// as shares of the motion in that time. Each run is simulated with the parameters that the other
/// runs ask for.
struct FreeRun {
  JointVector nominal = JointVector::Zero();    ///< RMS error over RMS motion, an axis each
  JointVector corrected = JointVector::Zero();  ///< the same of the best model
  JointVector noise = JointVector::Zero();      ///< the true model's on a replica: noise alone
  double motion_s = 0.0;                        ///< for which a model is left alone

  /// Readings less predictions of one run while the models are alone, NaN while they are held.
  struct Trace {
    std::size_t run = 0;
    std::vector<JointVector> nominal{};
    std::vector<JointVector> corrected{};
    std::vector<JointVector> deviation{};  ///< standard deviation of noise alone
  };
  std::vector<Trace> traces{};
};

[[nodiscard]] FreeRun free_run(const Likelihood& likelihood, const SearchResult& found);

}  // namespace teleop
