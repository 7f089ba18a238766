#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/recording.hpp"

namespace teleop {

/// Torques that might be left over: each follows one quantity of an axis or of the next one.

/// What a probe may look at, at one row.
struct ProbeRow {
  double q = 0.0;       ///< −1 to 1 over the range of the axis
  double v = 0.0;       ///< in units of its RMS
  double sign = 0.0;    ///< of v, smooth where v is within the noise
  double u = 0.0;       ///< in units of its RMS
  double u_rate = 0.0;  ///< in units of its RMS
  double t = 0.0;       ///< −1 to 1 over the run
  double q_other = 0.0;
  double v_other = 0.0;
  double sign_other = 0.0;
  double u_other = 0.0;
};

/// Scales of the rows, from all runs together.
struct ProbeScales {
  JointVector middle = JointVector::Zero();
  JointVector half_range = JointVector::Ones();
  JointVector speed = JointVector::Ones();
  JointVector torque = JointVector::Ones();
  JointVector torque_rate = JointVector::Ones();
};

[[nodiscard]] ProbeScales probe_scales(const DiagnosisCase& data,
                                       const std::vector<std::vector<PredictedState>>& states);

/// What axis `axis` and the next one do at row k of a run, whose states are `states`.
[[nodiscard]] ProbeRow probe_row(const Recording& run,
                                 const std::vector<PredictedState>& states,
                                 std::size_t k,
                                 Eigen::Index axis,
                                 const ProbeScales& scales);

/// How many quantities there are.
[[nodiscard]] std::size_t probe_count() noexcept;

/// Torque of one quantity at one row, of size one about.
[[nodiscard]] double probe_torque(std::size_t quantity, const ProbeRow& row);

/// The quantity in words: "direction × time".
[[nodiscard]] std::string probe_name(std::size_t quantity);

}  // namespace teleop
