#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// What an arm is asked to do at one instant of a probe motion.
struct ProbePoint {
  JointVector q = JointVector::Zero();       ///< rad, from home
  JointVector qd = JointVector::Zero();      ///< rad/s
  JointVector torque = JointVector::Zero();  ///< N m, on top of the law
};

/// A small safe motion that makes some physics show. All joints move, none far: what one joint
/// tells must not depend on which one is asked about.
struct ProbeMotion {
  std::string_view name{};
  std::string_view text{};   ///< what the arm does
  std::string_view tells{};  ///< what it tells apart
  double seconds = 0.0;      ///< that it takes
  bool stiff = false;        ///< its travel is too short for the weak law
  bool hands_off = false;    ///< nobody touches the arm
  ProbePoint (*at)(double t_s) = nullptr;
};

/// The motions that there are:
///
///   slow_sweep  two ways at one slow speed      friction, springs, cogging, weight over the angle
///   fast_sweep  the same range, fast            what grows with speed or acceleration
///   multisine   torques of 5 to 200 Hz          delays against lags against springs
///   triangles   ±10 counts, three rates, bias   play, presliding and Stribeck friction
///   rest_repeat hard work, rest, the same again heat against a gain
///   postures    held still, one after the other a gain against inertia, by the arm's own weight
///   hands_off   slow and fast, untouched        a hand against springs and damping
[[nodiscard]] std::span<const ProbeMotion> probe_motions() noexcept;

/// @throws ConfigError listing the names.
[[nodiscard]] const ProbeMotion& find_probe_motion(std::string_view name);

/// Follows a probe motion with weak springs and dampers at the joints, the weight carried:
///
///     τ = N(q) + K (home + q* − q) + B (q̇* − q̇) + τ*
///
/// Loop: step neither allocates nor throws.
class ProbeLaw {
 public:
  struct Config {
    std::array<double, kJoints> home_rad{0.0, 0.40, 0.25};
    std::array<double, kJoints> stiffness_Nm_per_rad{1.5, 0.8, 0.3};
    std::array<double, kJoints> damping_Nms_per_rad{0.02, 0.012, 0.005};
    double stiff_factor = 6.0;  ///< of the stiffness in motions that need it
  };

  ProbeLaw(const Config& config, const ArmModel& arm, const ProbeMotion& motion);

  /// Torques at one instant; `qd` measured or estimated.
  [[nodiscard]] JointVector step(double t_s,
                                 const JointVector& q,
                                 const JointVector& qd) const noexcept;

  /// Where the motion begins.
  [[nodiscard]] JointVector start() const noexcept;

 private:
  const ArmModel& arm_;
  const ProbeMotion& motion_;
  JointVector home_;
  JointVector stiffness_;
  JointVector damping_;
};

}  // namespace teleop
