#pragma once

#include <vector>

#include "core/diagnosis/noise_model.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/diagnosis/tether_covariance.hpp"
#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// The torque that a model misses at every row of a recording, from the readings before and after
/// it: the tether's disturbance estimate, smoothed by the backward pass of Bryson and Frazier
/// [Bierman 1977, section X.2] over the linear model of Tether. Nothing is differentiated.
///
/// The disturbance is let wander further than the noise of the recording does, with the same
/// roughness from sample to sample, so that a torque that stays is shown at its full size.
class TorqueSmoother {
 public:
  /// @param noise as fitted under the model that misses most
  TorqueSmoother(const ArmModel& arm,
                 const Recording& run,
                 double period_s,
                 const NoiseModel& noise);

  struct Row {
    JointVector q = JointVector::Zero();       ///< rad, of the tethered simulation
    JointVector qd = JointVector::Zero();      ///< rad/s
    JointVector torque = JointVector::Zero();  ///< N m, missing in the model
  };

  /// @returns nothing where the model runs away from the recording.
  [[nodiscard]] std::vector<Row> smooth(const PredictorModel& model) const;

 private:
  const Recording& run_;
  double period_s_;
  Tether tether_;
  TetherCovariance covariance_;
  std::vector<JointMatrix> mobility_;
  std::vector<TetherCovariance::Matrix> before_;  ///< each reading
};

}  // namespace teleop
