#include "core/control/computed_torque.hpp"

namespace teleop {

ComputedTorque::ComputedTorque(const Config& config, const ArmModel& arm) noexcept
    : Kp_{config.stiffness_per_s2.data()}, Kd_{config.damping_per_s.data()}, arm_{arm} {}

JointVector ComputedTorque::step(const JointVector& q,
                                 const JointVector& qd,
                                 const JointMotion& desired) const noexcept {
  const JointVector wanted =
      desired.qdd + Kd_.cwiseProduct(desired.qd - qd) + Kp_.cwiseProduct(desired.q - q);
  return inverse_dynamics(arm_, q, qd, wanted);
}

void add_settings(Settings& settings, const std::string& prefix, ComputedTorque::Config& config) {
  settings.add(prefix + "stiffness_per_s2", &config.stiffness_per_s2, "K_p of each joint",
               kNotNegative);
  settings.add(prefix + "damping_per_s", &config.damping_per_s, "K_d of each joint", kNotNegative);
}

}  // namespace teleop
