#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/time.hpp"
#include "core/effects/contact.hpp"
#include "core/effects/hand.hpp"
#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"
#include "core/simulation/actuation.hpp"
#include "core/simulation/friction_modes.hpp"
#include "core/simulation/joint_stops.hpp"
#include "core/simulation/motor.hpp"
#include "core/simulation/rigid_body.hpp"
#include "core/simulation/sensing.hpp"

namespace teleop {

/// An arm that moves: rigid body, drives and transmissions, friction, joint stops and walls, hands
/// and a surface at the tool,
///
///     M(q) q̈ + C q̇ + N = T + springs + stops + J_vᵀ (hand + grip + surface),
///     J m̈ = a + ripple + friction(m, ṁ) − T      on axes whose transmission gives way;
///     elsewhere m = q and T is everything right of J m̈ above.
///
/// a is the delivered torque (ActuationChain, Motor), T the transmitted one (Transmission).
///
/// Integrated by the classical Runge–Kutta method of order 4 between events. Events are the
/// instants at which the equation changes its form: a joint stops, comes loose or turns back, a
/// surface, stop or end of play is touched or left. Each is located within 1e-12 s by bracketing on
/// the step itself; there the forms are chosen anew from the state. So a joint that friction holds
/// is exactly at rest, and the error is of order 4 in the step in spite of friction and contact.
/// Delivered torques and the bending of bristles are known in closed form and cost no accuracy at
/// all.
///
/// Steps end at the knots of the hand's motion and where a delayed command arrives, and are never
/// longer than Config::max_step or a quarter of the shortest time constant that acts. An event
/// shorter than a step is found only where a speed or a depth turns back inside the step.
///
/// Thread: one. Loop: everything but the constructor is allocation-free, noexcept and bounded.
class Plant {
 public:
  struct Config {
    PlantTerms terms{};
    std::optional<Hand> hand{};
    std::optional<Contact> contact{};
    bool stops = true;
    Duration max_step{1'000'000};
    JointVector q = JointVector::Zero();  ///< at the start
    JointVector qd = JointVector::Zero();
  };

  /// Forces on the tool in B, N.
  struct ToolForces {
    Vector3 hand = Vector3::Zero();  ///< inertia of the hand included
    Vector3 contact = Vector3::Zero();
  };

  /// @pre max_step is positive and the state finite.
  Plant(const ArmModel& arm, const Config& config);

  /// Commanded joint torques, held until the next call. @pre finite
  void set_torque(const JointVector& tau) noexcept;

  /// Torques on the drives that no command asks for, held until the next call, N m. @pre finite
  void set_disturbance(const JointVector& torque) noexcept;

  /// A jump of the state. Where nothing gives way, drives go with their links.
  struct Shift {
    JointVector q = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    JointVector m = JointVector::Zero();
    JointVector md = JointVector::Zero();
  };
  /// Moves the arm at once, as an observer does that follows a recording. Where a play ends, the
  /// drive takes its link along. @pre finite
  void shift(const Shift& by) noexcept;

  /// The drive of the axis moves apart from its link.
  [[nodiscard]] bool is_split(std::size_t axis) const noexcept { return separate(axis); }

  /// Lets time pass. `sensing`, if given, sees every piece of the motion.
  void advance(Duration span, Sensing* sensing = nullptr) noexcept;

  [[nodiscard]] const JointVector& q() const noexcept { return q_; }
  [[nodiscard]] const JointVector& qd() const noexcept { return qd_; }
  [[nodiscard]] const JointVector& drive_q() const noexcept { return m_; }    ///< m
  [[nodiscard]] const JointVector& drive_qd() const noexcept { return md_; }  ///< ṁ
  [[nodiscard]] Duration time() const noexcept { return time_; }
  [[nodiscard]] const std::array<Motor, kJoints>& motors() const noexcept { return motors_; }

  /// The following hold for the torque that was last set.
  [[nodiscard]] JointVector qdd() noexcept;
  [[nodiscard]] ToolForces tool_forces() noexcept;
  [[nodiscard]] Vector3 tool_acceleration() noexcept;  ///< in B, m/s²
  [[nodiscard]] const SlidingModes& sliding() noexcept;
  [[nodiscard]] JointVector delivered_torque() noexcept;  ///< a with ripple, N m

  /// Kinetic energy, masses of hand and grip included, weight and every spring, J.
  [[nodiscard]] double energy() noexcept;

  /// Fastest rate at which hand, surface and effects act, 1/s; motors and stops apart.
  [[nodiscard]] double fastest_rate() const noexcept { return fastest_rate_; }

  /// Events since the start.
  [[nodiscard]] std::uint64_t events() const noexcept { return events_; }

 private:
  /// Share of the shortest time constant that a step may take: it errs 1e-5 of a vibration a step.
  static constexpr double kStepOverTimeConstant = 0.25;

  /// Which side of its play an axis touches.
  using Touch = std::array<signed char, kJoints>;

  /// Angles and speeds of links and drives.
  struct Motion {
    JointVector q = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    JointVector m = JointVector::Zero();
    JointVector md = JointVector::Zero();
  };
  struct Rates {
    JointVector qdd = JointVector::Zero();
    JointVector mdd = JointVector::Zero();
    JointVector hold = JointVector::Zero();   ///< that friction takes up where it sticks, N m
    JointVector drive = JointVector::Zero();  ///< torque on the drive but for T and dry friction
  };
  /// Everything at one instant that forms, events and readings need.
  struct Look {
    RigidBody::Angles angles{};
    RigidBody::Tool tool{};
    Contact::Depth depth{};
    Rates rates{};
  };
  struct Trial {
    Motion at{};
    Look look{};
    double margin = 0.0;
  };
  /// A stage of a step, away from the present by these turns and `dt`.
  struct Stage {
    double dt = 0.0;
    JointVector turn = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    JointVector drive_turn = JointVector::Zero();
    JointVector md = JointVector::Zero();
  };

  void set_rates(const ArmModel& arm);
  [[nodiscard]] Look look(double dt, const Motion& at) const noexcept;
  [[nodiscard]] Rates rates(const Stage& stage,
                            const RigidBody::Angles& angles,
                            Look* seen) const noexcept;
  [[nodiscard]] Rates accelerate_all(const RigidBody::Inertia& inertia,
                                     const JointVector& link,
                                     const JointVector& drive,
                                     const JointVector& transmitted) const noexcept;
  [[nodiscard]] RigidBody::Inertia effective(RigidBody::Inertia inertia) const noexcept;
  [[nodiscard]] JointVector delivered(double dt, const JointVector& m) const noexcept;
  [[nodiscard]] JointVector drive_torque(const Stage& stage) const noexcept;
  [[nodiscard]] double smooth_friction(std::size_t axis, double turn, double v) const noexcept;
  [[nodiscard]] Vector3 tool_force(double s, const Look& at) const noexcept;
  [[nodiscard]] double margin(const Motion& at, const Look& look) const noexcept;
  [[nodiscard]] double pressed(std::size_t axis, const Look& look) const noexcept;
  [[nodiscard]] Trial step(double h) noexcept;
  [[nodiscard]] std::optional<double> dip(double h, const Trial& end) const noexcept;
  [[nodiscard]] double locate(double h, Trial& end) noexcept;
  [[nodiscard]] double longest_step() const noexcept;
  [[nodiscard]] bool rests() const noexcept;
  void integrate(double length, Sensing* sensing) noexcept;
  void run_motors(double h) noexcept;
  void commit(double h, const Trial& end, Sensing* sensing) noexcept;
  void pass(double dt) noexcept;
  void observe(double h, const Motion& end, Sensing* sensing) noexcept;
  void settle() noexcept;
  void choose_forms() noexcept;
  void resolve_modes() noexcept;
  void close_plays() noexcept;
  void collide(std::size_t axis, signed char side) noexcept;
  void refresh() noexcept;

  [[nodiscard]] bool separate(std::size_t axis) const noexcept {
    switch (config_.terms.transmission[axis].kind) {
      case Transmission::Kind::compliant:
        return true;
      case Transmission::Kind::play:
        return touch_[axis] == 0;
      default:
        return false;
    }
  }

  RigidBody body_;  ///< with the masses that hands add
  JointStops stops_;
  Config config_;
  ActuationChain chain_;
  std::array<Motor, kJoints> motors_;
  Vector3 grip_point_ = Vector3::Zero();
  bool motors_act_ = false;
  bool splits_ = false;  ///< some transmission gives way
  bool springs_ = false;
  bool bristles_ = false;
  bool peaks_ = false;
  bool ripples_ = false;
  bool tendons_ = false;
  double inertia_ = 0.0;  ///< bound of the joints' inertias from below, kg m²
  double fastest_rate_ = 0.0;
  double calm_step_ = 0.0;     ///< longest step, s, with neither surface nor stop
  double contact_step_ = 0.0;  ///< and with the surface
  double motor_step_ = 0.0;

  JointVector q_;
  JointVector qd_;
  JointVector m_;
  JointVector md_;
  JointVector bristle_ = JointVector::Zero();  ///< z, N m
  JointVector tau_ = JointVector::Zero();
  JointVector motor_torque_ = JointVector::Zero();
  JointVector disturbance_ = JointVector::Zero();
  Duration time_{0};
  Duration since_knot_{0};
  double s_ = 0.0;  ///< since the hand's knot; since the start of an advance without hand

  SlidingModes sliding_{};
  Touch touch_{};
  bool touching_ = false;
  JointStops::Set stopped_ = 0;
  Look now_{};
  bool commanded_ = false;
  bool torque_is_new_ = true;
  bool shifted_ = false;
  std::uint64_t events_ = 0;
};

}  // namespace teleop
