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

/// Torques that follow angle, speed, its sign, command, acceleration, time and the other axes, one
/// after the other, as score tests through the tether. The largest gain comes first. Under a
/// sufficient model each gain is distributed as χ² with the degrees of freedom of its quantity.
[[nodiscard]] std::vector<Leftover> leftovers(const Likelihood& likelihood, const Fit& now);

}  // namespace teleop
