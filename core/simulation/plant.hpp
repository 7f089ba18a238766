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
#include "core/simulation/encoder_edges.hpp"
#include "core/simulation/friction_modes.hpp"
#include "core/simulation/joint_stops.hpp"
#include "core/simulation/rigid_body.hpp"

namespace teleop {

/// An arm that moves: rigid body, friction, joint stops, a hand and a surface at the tool,
///
///     M(q) q̈ + C q̇ + N = τ + friction + stops + J_vᵀ (hand + surface),
///
/// integrated by the classical Runge–Kutta method of order 4 between events. Events are the
/// instants at which the equation changes its form: a joint stops, comes loose or turns back, a
/// surface or stop is touched or left. Each is located within 1e-12 s by bracketing on the step
/// itself; there the forms are chosen anew from the state alone. So a joint that friction holds is
/// exactly at rest, and the error is of order 4 in the step in spite of friction and contact.
///
/// Steps end at the knots of the hand's motion and are never longer than Config::max_step or a
/// quarter of the shortest time constant of the springs and dampers that act.
/// An event shorter than a step is found only where a speed or a depth turns back inside the step.
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

  /// Fastest rates at which a plant can move, 1/s.
  struct Rates {
    double always = 0.0;   ///< hand and friction
    double contact = 0.0;  ///< against the surface
    double stops = 0.0;    ///< against a joint stop
  };
  [[nodiscard]] static Rates rates(const ArmModel& arm, const Config& config) noexcept;

  /// @pre max_step is positive and the state finite.
  Plant(const ArmModel& arm, const Config& config);

  /// Joint torques of the motors, held until the next call. @pre finite
  void set_torque(const JointVector& tau) noexcept;

  /// Lets time pass. `edges`, if given, sees every piece of the motion.
  void advance(Duration span, EncoderEdges* edges = nullptr) noexcept;

  [[nodiscard]] const JointVector& q() const noexcept { return q_; }
  [[nodiscard]] const JointVector& qd() const noexcept { return qd_; }
  [[nodiscard]] Duration time() const noexcept { return time_; }

  /// The following hold for the torque that was last set.
  [[nodiscard]] JointVector qdd() noexcept;
  [[nodiscard]] ToolForces tool_forces() noexcept;
  [[nodiscard]] const SlidingModes& sliding() noexcept;

  /// Kinetic energy, the hand's mass included, weight and springs of stops, surface and hand, J.
  [[nodiscard]] double energy() noexcept;

  /// Events since the start.
  [[nodiscard]] std::uint64_t events() const noexcept { return events_; }

 private:
  /// Everything at one instant that forms, events and readings need.
  struct Look {
    RigidBody::Angles angles{};
    RigidBody::Tool tool{};
    Contact::Depth depth{};
    Acceleration motion{};
  };
  struct Trial {
    JointVector q = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    Look look{};
    double margin = 0.0;
  };

  template <bool kSettle>
  [[nodiscard]] Look look(double s, const JointVector& q, const JointVector& qd) noexcept;
  [[nodiscard]] JointVector acceleration(double s,
                                         const JointVector& turn,
                                         const JointVector& qd) const noexcept;
  [[nodiscard]] JointVector smooth_torque(const JointVector& q,
                                          const JointVector& qd) const noexcept;
  [[nodiscard]] Vector3 tool_force(double s, const Look& at) const noexcept;
  [[nodiscard]] double margin(const JointVector& q,
                              const JointVector& qd,
                              const Look& at) const noexcept;
  [[nodiscard]] Trial step(double h) noexcept;
  [[nodiscard]] std::optional<double> dip(double h, const Trial& end) const noexcept;
  [[nodiscard]] double locate(double h, Trial& end) noexcept;
  [[nodiscard]] double longest_step() const noexcept;
  [[nodiscard]] bool rests() const noexcept;
  void integrate(double length, EncoderEdges* edges) noexcept;
  void commit(double h, const Trial& end, EncoderEdges* edges) noexcept;
  void settle() noexcept;
  void refresh() noexcept;

  RigidBody body_;  ///< with the hand's mass
  JointStops stops_;
  Config config_;
  double calm_step_ = 0.0;     ///< longest step, s, with neither surface nor stop
  double contact_step_ = 0.0;  ///< and with the surface
  double stop_step_ = 0.0;     ///< and with a stop

  JointVector q_;
  JointVector qd_;
  JointVector tau_ = JointVector::Zero();
  Duration time_{0};
  Duration since_knot_{0};
  double s_ = 0.0;  ///< since the hand's knot; since the start of an advance without hand

  SlidingModes sliding_{};
  bool touching_ = false;
  JointStops::Set stopped_ = 0;
  Look now_{};
  bool torque_is_new_ = true;
  std::uint64_t events_ = 0;
};

}  // namespace teleop
