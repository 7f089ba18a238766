#pragma once

#include "core/effects/effect.hpp"

namespace teleop {

/// Dry friction of a joint, f = −level (1 + asymmetry sgn q̇) sgn q̇ with sgn 0 the whole interval
/// [−1, 1]: a joint at rest stays at rest, exactly, until more than level (1 ± asymmetry) asks it
/// to move.
extern const EffectKind coulomb_friction;

}  // namespace teleop
