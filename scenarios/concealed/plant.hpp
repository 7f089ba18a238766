#pragma once

#include <array>
#include <vector>

#include "core/math/joint_vector.hpp"
#include "scenarios/concealed/delivery.hpp"
#include "scenarios/concealed/law.hpp"

namespace teleop::concealed {

/// The concealed device in motion, by Moreau's time stepping [Moreau 1988]: with a fixed short step
/// h
///
///     q½ = q + h/2 q̇,   q̇⁺ = q̇ + M(q½)⁻¹ (h F(q½, q̇½) + p),   q⁺ = q½ + h/2 q̇⁺,
///
/// q̇½ extrapolated from the step before. Dry friction and play are set-valued: their impulses p
/// solve
///
///     p ∈ −h [level] Sgn(ṁ⁺),     0 ≤ P ⊥ −s (ṁ⁺ − q̇⁺) ≥ 0 where the play is closed on side s
///
/// by projection (Gauss–Seidel over the axes). No events are searched for: a joint sticks where its
/// projected velocity is exactly zero, impacts are plastic. Order two where the motion is smooth.
/// Written anew from the definitions of the answer format, with nothing in common with
/// core/simulation, so that its recordings are foreign to it.
///
/// Thread: one. Not for a loop: commands are kept.
class Plant {
 public:
  struct Motion {
    JointVector q = JointVector::Zero();  ///< link, rad
    JointVector v = JointVector::Zero();
    JointVector m = JointVector::Zero();  ///< drive, in joint radians
    JointVector w = JointVector::Zero();
  };
  /// The middle of a step and what happened in it.
  struct Moment {
    Motion at{};
    double t = 0.0;
    JointVector link_acceleration = JointVector::Zero();
    JointVector drive_acceleration = JointVector::Zero();
    JointVector delivered = JointVector::Zero();  ///< a with bias, ripple and coupling, N m
    JointVector friction = JointVector::Zero();   ///< f^drive, N m
  };

  /// @param substeps a sample period, even
  Plant(const PlantLaw& law, const JointVector& q, const JointVector& v, int substeps);

  /// The command that is held until the next one.
  void command(const JointVector& u);

  /// Half a sample period under a disturbance on the drives, N m.
  void advance_half(const JointVector& disturbance);

  /// Readings taken `late` s ago, before noise, slips and rounding.
  [[nodiscard]] JointVector reading(double late = 0.0) const;

  /// Shifts angles and velocities, as an observer does. Where a play is open only the drive is
  /// shifted, and takes the link along from the end of the play on.
  void correct(const JointVector& by_q, const JointVector& by_v);
  /// The play of an axis was open at the last step.
  [[nodiscard]] bool open(std::size_t axis) const noexcept {
    return law_.axes[axis].transmission.play && closed_[axis] == 0;
  }

  [[nodiscard]] const Motion& motion() const noexcept { return now_; }
  [[nodiscard]] const Moment& last() const noexcept { return last_; }
  [[nodiscard]] double time() const noexcept { return t_; }
  [[nodiscard]] double period() const noexcept { return period_; }
  /// Kinetic energy, weight and springs, J.
  [[nodiscard]] double energy() const noexcept;

 private:
  struct Body;

  void step(const JointVector& disturbance);
  void drive_torques(const Motion& at, const JointVector& disturbance);
  [[nodiscard]] JointVector link_torques(const Body& body, const Motion& at) noexcept;
  [[nodiscard]] JointVector hand_torque(const Motion& at) const noexcept;
  void project(const Body& body, const Motion& middle, Motion& end);
  [[nodiscard]] bool project_friction(const Body& body, std::size_t i, Motion& end) noexcept;
  [[nodiscard]] bool project_play(const Body& body, std::size_t i, Motion& end) noexcept;
  void move_memory(const Motion& middle) noexcept;
  void arrive(const Motion& middle, Motion& end, bool impact) noexcept;
  [[nodiscard]] JointVector past(double ago) const noexcept;

  PlantLaw law_;
  double period_ = 1e-3;
  double h_ = 25e-6;
  int substeps_ = 40;
  bool set_valued_ = false;
  std::array<Delivery, kJoints> delivery_;
  JointVector hand_point_ = JointVector::Zero();

  Motion now_{};
  JointVector link_rate_ = JointVector::Zero();  ///< accelerations for the extrapolation
  JointVector drive_rate_ = JointVector::Zero();
  JointVector command_ = JointVector::Zero();
  JointVector bristle_ = JointVector::Zero();   ///< N m
  JointVector loading_ = JointVector::Zero();   ///< −1 unloading, +1 moving up
  JointVector absorber_ = JointVector::Zero();  ///< angle of the hung inertia
  JointVector absorber_rate_ = JointVector::Zero();
  double t_ = 0.0;

  JointVector drive_torque_ = JointVector::Zero();
  std::array<FrictionLaw::Levels, kJoints> levels_{};
  JointVector friction_impulse_ = JointVector::Zero();
  JointVector play_impulse_ = JointVector::Zero();
  std::array<int, kJoints> closed_{};  ///< side of the play that is closed, 0: none
  std::array<bool, kJoints> stuck_{};
  Moment last_{};

  std::vector<JointVector> history_{};  ///< of m, a ring; empty where nothing reads late
  std::size_t newest_ = 0;
  JointVector start_m_ = JointVector::Zero();
  JointVector start_w_ = JointVector::Zero();
};

}  // namespace teleop::concealed
