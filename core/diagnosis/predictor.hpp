#pragma once

#include <cstddef>
#include <vector>

#include "core/diagnosis/recording.hpp"
#include "core/diagnosis/tether.hpp"
#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// What a model says of a recording, one sample ahead: the arm with its effects is simulated under
/// the recorded commands, and at each reading the tether moves it towards what was read
/// (innovations form).

/// State of the tethered simulation before each reading, for whoever looks where it errs.
struct PredictedState {
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();
  JointVector disturbance = JointVector::Zero();  ///< N m
};

struct PredictorModel {
  const ArmModel& arm;
  const PlantTerms& terms;
  int steps = 1;  ///< of the integrator, at least so many a sample
  /// n: the simulation is held for n rows, then left to itself for n, and so on; 0: always held.
  std::size_t free_rows = 0;
};

struct Prediction {
  /// Reading less prediction, rad, at every row; not a number where the model runs away or is too
  /// stiff to follow.
  std::vector<JointVector> innovations{};
  /// Their standard deviation on axes whose drive moves apart from the link, 0 on the others, rad.
  /// Empty: on no axis ever.
  std::vector<JointVector> apart{};
};

/// Whether drives can move apart from their links.
[[nodiscard]] bool gives_way(const PlantTerms& terms);

/// @param states filled when given
[[nodiscard]] Prediction predict(const PredictorModel& model,
                                 const Recording& run,
                                 double period_s,
                                 const Tether& tether,
                                 std::vector<PredictedState>* states = nullptr);

}  // namespace teleop
