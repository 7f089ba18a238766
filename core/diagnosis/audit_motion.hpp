#pragma once

#include <optional>

#include "core/diagnosis/recording.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// How the commands of a run go with the inertial torques of the nominal model, after everything
/// that depends on position and speed has been taken out of both; see audit().
struct CommandFit {
  JointMatrix correlation = JointMatrix::Zero();  ///< (i, j): command i and inertial torque j
  JointMatrix share = JointMatrix::Zero();  ///< least-squares command i a unit of inertial torque j
  JointVector torque = JointVector::Zero();  ///< RMS of the inertial torques left
};

/// Nothing when the run is too short. Of a bench the inertial torque is the acceleration times the
/// inertia, 1 where that is free.
[[nodiscard]] std::optional<CommandFit> fit_commands(const DiagnosisCase& of,
                                                     const ArmModel* arm,
                                                     const Recording& run);

}  // namespace teleop
