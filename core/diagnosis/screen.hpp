#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnosis/fit.hpp"
#include "core/diagnosis/likelihood.hpp"
#include "core/effects/effect.hpp"

namespace teleop {

/// An effect that might be missing, at the size that the recordings ask for to first order.
struct Candidate {
  EffectSpec effect{};
  double gain = 0.0;  ///< by which χ² should fall
};

/// What the axes did in all recordings together.
[[nodiscard]] MachineUse use_of(const DiagnosisCase& data, const ArmModel& arm);

/// Every trial of every kind of the vocabulary on every axis, as score test against the model: the
/// errors' slope by the effect's size, less what the parameters at hand explain of it. The largest
/// gain comes first. Trials that would need an impossible size are left out.
[[nodiscard]] std::vector<Candidate> screen(const Likelihood& likelihood,
                                            const Fit& now,
                                            const MachineUse& use);

}  // namespace teleop
