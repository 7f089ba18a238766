#pragma once

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
};

/// Reading less prediction, rad, at every row; not a number where the model runs away or is too
/// stiff to follow.
/// @param states filled when given
[[nodiscard]] std::vector<JointVector> innovations(const PredictorModel& model,
                                                   const Recording& run,
                                                   double period_s,
                                                   const Tether& tether,
                                                   std::vector<PredictedState>* states = nullptr);

}  // namespace teleop
