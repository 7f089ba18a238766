#pragma once

#include <vector>

#include "core/diagnosis/noise_model.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// The gains that hold a simulation to a recording: the Kalman filter of
///
///     q⁺ = q + h v + h²/2 W (d + w),   v⁺ = v + h W (d + w),   d⁺ = φ d + noise,   y = q + noise
///
/// with W = M(q)⁻¹ along the readings. Weight, Coriolis terms and the effects change within a
/// sample less than the gains care for; the simulation itself knows them.
class Tether {
 public:
  /// At one reading, before it is used.
  struct Step {
    JointMatrix position = JointMatrix::Zero();     ///< rad per rad of innovation
    JointMatrix velocity = JointMatrix::Zero();     ///< rad/s per rad
    JointMatrix disturbance = JointMatrix::Zero();  ///< N m per rad
    JointMatrix whitening = JointMatrix::Zero();    ///< lower triangular, unit variance out
    double log_determinant = 0.0;                   ///< of the innovation's covariance
  };

  /// @param rows how many of the run's; 0: all
  Tether(const ArmModel& arm,
         const Recording& run,
         double period_s,
         const NoiseModel& noise,
         std::size_t rows = 0);

  [[nodiscard]] const std::vector<Step>& steps() const noexcept { return steps_; }
  [[nodiscard]] const NoiseModel& noise() const noexcept { return noise_; }
  [[nodiscard]] const JointVector& memory() const noexcept { return memory_; }  ///< φ

 private:
  NoiseModel noise_;
  std::vector<Step> steps_;
  JointVector memory_;
};

/// M⁻¹ at each reading.
[[nodiscard]] std::vector<JointMatrix> mobilities(const ArmModel& arm, const Recording& run);

}  // namespace teleop
