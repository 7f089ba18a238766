#pragma once

#include <array>
#include <string>

#include "core/base/settings.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {

/// Joint tracking through the inverse of the model,
///
///     τ = M(q) (q̈_d + K_d ė + K_p e) + C(q, q̇) q̇ + N(q),   e = q_d − q,
///
/// so that on an arm that is the model each joint's error obeys ë + K_d ė + K_p e = 0
/// [Murray 1994, section 4.5]. The defaults place both roots of every joint at −40 rad/s.
/// Thread: any. Loop: step neither allocates, blocks nor throws.
class ComputedTorque {
 public:
  struct Config {
    std::array<double, 3> stiffness_per_s2{1600.0, 1600.0, 1600.0};  ///< K_p
    std::array<double, 3> damping_per_s{80.0, 80.0, 80.0};           ///< K_d
  };

  struct JointMotion {
    JointVector q = JointVector::Zero();    ///< rad
    JointVector qd = JointVector::Zero();   ///< rad/s
    JointVector qdd = JointVector::Zero();  ///< rad/s²
  };

  /// Keeps a reference: the model must outlive this.
  ComputedTorque(const Config& config, const ArmModel& arm) noexcept;

  /// Joint torques for posture `q` and joint speeds `qd`.
  [[nodiscard]] JointVector step(const JointVector& q,
                                 const JointVector& qd,
                                 const JointMotion& desired) const noexcept;

 private:
  JointVector Kp_;
  JointVector Kd_;
  const ArmModel& arm_;
};

void add_settings(Settings& settings, const std::string& prefix, ComputedTorque::Config& config);

}  // namespace teleop
