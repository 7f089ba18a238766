#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/diagnosis/fit.hpp"
#include "core/diagnosis/likelihood.hpp"

namespace teleop {

/// A regularity that is left in the errors of a model: torque on one axis that follows a quantity.
struct Leftover {
  std::size_t axis = 0;
  std::string quantity{};  ///< in words: "sign of speed × time"
  double gain = 0.0;       ///< by which χ² falls if it is added
  double amplitude = 0.0;  ///< N m, RMS of what it adds
};

struct Leftovers {
  std::vector<Leftover> all{};  ///< the largest gain first
  double p_value = 1.0;         ///< of the largest gain of a torque, if nothing is left
};

/// Torques that follow angle, speed, its sign, command, acceleration, time and the other axes, one
/// after the other, as score tests through the tether; stretches of time and jumps that stand out.
/// Under a sufficient model the gain of a torque is about χ² of one degree; chances are resampled
/// from the recordings themselves.
[[nodiscard]] Leftovers leftovers(const Likelihood& likelihood, const Fit& now);

}  // namespace teleop
