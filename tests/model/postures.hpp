#pragma once

#include <cstdlib>
#include <numbers>

#include "core/math/random.hpp"
#include "core/model/arm_model.hpp"
#include "core/model/kinematics.hpp"

namespace teleop::testing {

/// How many cases a property is tried on.
[[nodiscard]] inline int cases() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): tests run in one thread
  const char* wanted = std::getenv("TELEOP_CASES");
  return wanted == nullptr ? 2000 : std::atoi(wanted);
}

[[nodiscard]] inline const ArmModel& phantom() {
  static const ArmModel arm = load_arm("phantom-1.5");
  return arm;
}

[[nodiscard]] inline JointVector random_vector(Random& random, double bound) {
  return {random.uniform(-bound, bound), random.uniform(-bound, bound),
          random.uniform(-bound, bound)};
}

/// Any posture, whether or not the stops allow it.
[[nodiscard]] inline JointVector random_posture(Random& random) {
  return random_vector(random, std::numbers::pi);
}

/// A posture that the stops allow.
[[nodiscard]] inline JointVector random_allowed_posture(Random& random) {
  for (;;) {
    const JointVector q = random_posture(random);
    if (check_limits(phantom(), q) == Reach::ok) return q;
  }
}

}  // namespace teleop::testing
