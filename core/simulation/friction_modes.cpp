#include "core/simulation/friction_modes.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace teleop {
namespace {

constexpr std::array kAtRest{Sliding::stuck, Sliding::forward, Sliding::backward};

/// The modes that a joint may be in, as a part of kAtRest.
std::span<const Sliding> candidates(const JointFriction& friction, double speed) noexcept {
  const std::span<const Sliding> all{kAtRest};
  if (!friction.has_corner() || speed > 0.0) return all.subspan(1, 1);
  if (speed < 0.0) return all.subspan(2, 1);
  return all;
}

/// By how much torque the modes of the joints at rest contradict themselves; 0: not at all.
double contradiction(const RigidBody::Inertia& body,
                     const std::array<JointFriction, kJoints>& friction,
                     const JointVector& qd,
                     const Acceleration& motion,
                     const SlidingModes& modes) noexcept {
  const std::array inertia{body.M11, body.M22, body.M33};
  double worst = 0.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    if (!friction[i].has_corner() || qd[joint] != 0.0) continue;
    if (modes[i] == Sliding::stuck) {
      worst = std::max({worst, motion.hold[joint] - friction[i].dry_forward,
                        -friction[i].dry_backward - motion.hold[joint]});
    } else {
      worst = std::max(worst, -static_cast<double>(modes[i]) * motion.qdd[joint] * inertia[i]);
    }
  }
  return worst;
}

}  // namespace

SlidingModes resolve_friction(const RigidBody::Inertia& body,
                              const std::array<JointFriction, kJoints>& friction,
                              const JointVector& qd,
                              const JointVector& net) noexcept {
  SlidingModes best{Sliding::forward, Sliding::forward, Sliding::forward};
  double least = std::numeric_limits<double>::infinity();
  for (const Sliding one : candidates(friction[0], qd[0])) {
    for (const Sliding two : candidates(friction[1], qd[1])) {
      for (const Sliding three : candidates(friction[2], qd[2])) {
        const SlidingModes modes{one, two, three};
        const double wrong =
            contradiction(body, friction, qd, accelerate(body, friction, net, modes), modes);
        if (wrong == 0.0) return modes;
        if (wrong < least) {
          least = wrong;
          best = modes;
        }
      }
    }
  }
  return best;
}

}  // namespace teleop
