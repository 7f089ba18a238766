#pragma once

#include <vector>

#include "scenarios/scoring/case_truth.hpp"

namespace teleop {

/// Kinds that predict the same recordings as an effect by construction, itself not included:
///
///   1. actuation and sensor delay of one axis, and an amplifier's lag with them below 0.8 ms;
///   2. torque gain and encoder scale of axes 1 and 3, whose weight is none or nearly linear;
///      on axis 1 also added inertia, while the departure is a loss below 3 %;
///   3. presliding below 0.2 mrad, or a Stribeck dip below 10 % or 3 mrad/s: Coulomb friction;
///   4. a base tilt about z: a torque bias of axis 1;
///   5. an eccentric encoder near its zero crossing: encoder scale, on axis 1 also torque gain.
///
/// In 3 to 5 the simpler kind stands for the richer one, not the reverse.
[[nodiscard]] std::vector<EffectName> equivalents(const TrueEffect& effect);

}  // namespace teleop
