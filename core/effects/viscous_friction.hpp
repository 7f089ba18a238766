#pragma once

#include "core/effects/effect.hpp"

namespace teleop {

/// Viscous friction of a joint, f = −coefficient (1 + asymmetry sgn q̇) q̇.
extern const EffectKind viscous_friction;

}  // namespace teleop
