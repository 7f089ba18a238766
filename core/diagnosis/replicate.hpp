#pragma once

#include <cstdint>

#include "core/diagnosis/likelihood.hpp"

namespace teleop {

/// Recordings as a machine would give them that is just what a model says it is, shaken by its
/// noise: every run anew under the recorded commands, to which a weak law adds what keeps the arm
/// near the recorded motion; counted readings. Parametric bootstrap: what a fit or a test makes of
/// these shows its bias.
/// @param model with the noise that goes with it
[[nodiscard]] DiagnosisCase replicate(const Likelihood& likelihood,
                                      const MachineModel& model,
                                      const NoiseModel& noise,
                                      std::uint64_t seed);

}  // namespace teleop
