#pragma once

#include <string>
#include <vector>

#include "scenarios/velocity_study.hpp"

namespace teleop {

/// One gnuplot script that draws NAME.png.
struct VelocityPicture {
  std::string name;
  std::string script;
};

/// velocity-stretch: all estimates over the reference, once fast and once slow; velocity-error:
/// error by speed; velocity-lag-noise: lag against noise, with the damping that each allows.
[[nodiscard]] std::vector<VelocityPicture> velocity_pictures(const VelocityStudy& study);

}  // namespace teleop
