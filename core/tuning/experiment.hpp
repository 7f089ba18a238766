#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "core/estimation/velocity_estimator.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// The paper's experiments on loop gain [Cavusoglu 2002, section 4.2]. Each law acts along one tool
/// axis e, x = e · J(q₀) (q − q₀):
///
///     wall      u = −G x − B v            G is looked for; a spring that pulls as well as pushes,
///     so
///                                         the margin of a wall in which the tool stays pressed
///     damping   u = −G x − B v            B is looked for
///     teleop    u_m = −G (x_m − x_s) − B (v_m − v_s), u_s = −u_m          G is looked for
enum class GainExperiment : std::uint8_t { wall, damping, teleop };

[[nodiscard]] constexpr std::string_view name_of(GainExperiment experiment) noexcept {
  switch (experiment) {
    case GainExperiment::wall:
      return "wall";
    case GainExperiment::damping:
      return "damping";
    case GainExperiment::teleop:
      return "teleop";
  }
  return "unknown";
}

[[nodiscard]] constexpr std::string_view unit_of(GainExperiment experiment) noexcept {
  return experiment == GainExperiment::damping ? "N s/m" : "N/m";
}

inline constexpr std::size_t kMostArms = 2;

/// One arm near a pose, where its Jacobian is taken for constant: displacement of the tool
/// d = J (q − q₀), torque of a tool force τ = Jᵀ f + hold. In B, SI.
struct ToolFrame {
  JointVector q0 = JointVector::Zero();
  Matrix3 J = Matrix3::Identity();            ///< J_v(q₀)
  JointVector hold_Nm = JointVector::Zero();  ///< against gravity at q₀
  JointVector counts_per_rev = JointVector::Ones();

  [[nodiscard]] Vector3 displacement(const JointVector& q) const noexcept { return J * (q - q0); }

  /// How far the tool moves along an axis while the encoders move by a count.
  [[nodiscard]] double quantum_m(Eigen::Index axis) const noexcept;
};

/// What is tried: the experiment, the law's fixed parts and the weak loops that hold the other axes
/// and, between probes, the axis under test as well.
struct ExperimentConfig {
  GainExperiment experiment = GainExperiment::wall;
  std::size_t axis = 0;                  ///< 0, 1, 2: x, y, z
  double stiffness_N_per_m = 0.0;        ///< G where B is looked for
  double damping_Ns_per_m = 0.0;         ///< B where G is looked for
  VelocityEstimator::Config velocity{};  ///< of the law
  int peer_delay_samples = 0;            ///< age of the other arm's motion (teleop)
  double hold_stiffness_N_per_m = 60.0;
  double hold_damping_Ns_per_m = 0.6;
};

}  // namespace teleop
