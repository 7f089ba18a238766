#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "scenarios/concealed/delivery.hpp"
#include "scenarios/concealed/plant.hpp"
#include "tests/concealed/loops.hpp"

namespace teleop::concealed {
namespace {

using testing::excitation;
using testing::on;
using testing::phantom;
using testing::plant_with;
using testing::whole;

constexpr double kGravity = 9.81;

/// A moment of a plant and the command that was held.
struct Seen {
  Plant::Moment moment{};
  JointVector u = JointVector::Zero();
  [[nodiscard]] double q(Eigen::Index i) const { return moment.at.q[i]; }
  [[nodiscard]] double v(Eigen::Index i) const { return moment.at.v[i]; }
};
/// What the nominal arm lacks there, by the definition of the format.
using Law = std::function<JointVector(const Seen&)>;

void expect_law(const Effect& effect, const Law& law) {
  SCOPED_TRACE(effect.kind);
  Plant plant = plant_with({effect});
  double largest = 0.0;
  for (int tick = 0; tick < 1500; ++tick) {
    Seen seen{.u = excitation(tick, plant.motion().q, plant.motion().v)};
    plant.command(seen.u);
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    seen.moment = plant.last();
    const JointVector missing = inverse_dynamics(phantom(), seen.moment.at.q, seen.moment.at.v,
                                                 seen.moment.link_acceleration) -
                                seen.u;
    const JointVector expected = law(seen);
    ASSERT_LT((missing - expected).cwiseAbs().maxCoeff(), 1e-11) << "at " << tick << " ms";
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 2e-4) << "the effect has to show";
}

JointVector only(Eigen::Index axis, double torque) { return torque * JointVector::Unit(axis); }
double sign(double x) { return x > 0.0 ? 1.0 : -1.0; }

TEST(ConcealedLaws, OfActuationActOnTheCommand) {
  expect_law(on(1, "torque_gain", {{"gain", 0.93}}),
             [](const Seen& s) { return only(1, -0.07 * s.u[1]); });
  expect_law(on(0, "torque_saturation", {{"limit", 0.02}}),
             [](const Seen& s) { return only(0, std::clamp(s.u[0], -0.02, 0.02) - s.u[0]); });
  expect_law(on(2, "torque_deadzone", {{"threshold", 0.004}}), [](const Seen& s) {
    const double u = s.u[2];
    return only(2, std::abs(u) <= 0.004 ? -u : -0.004 * sign(u));
  });
  expect_law(on(0, "torque_bias", {{"bias", -0.003}}), [](const Seen&) { return only(0, -0.003); });
  expect_law(on(2, "torque_ripple", {{"amplitude", 0.003}, {"period", 0.1}, {"phase", 0.4}}),
             [](const Seen& s) {
               return only(2, 0.003 * std::sin(2.0 * std::numbers::pi * s.q(2) / 0.1 + 0.4));
             });
  expect_law(on(1, "axis_coupling", {{"fraction", 0.1}, {"from_axis", 3.0}}),
             [](const Seen& s) { return only(1, 0.1 * s.u[2]); });
}

TEST(ConcealedLaws, OfFrictionOpposeTheMotion) {
  expect_law(on(1, "viscous_friction", {{"coefficient", 0.01}, {"asymmetry", 0.3}}),
             [](const Seen& s) { return only(1, -0.01 * (1.0 + 0.3 * sign(s.v(1))) * s.v(1)); });
  // Where the joint stops within the step the projection decides: between the two bounds.
  const auto dry = [](Eigen::Index i, const std::function<double(const Seen&)>& law) {
    return [=](const Seen& s) {
      const double start = s.v(i) - 0.6 * 25e-6 * s.moment.link_acceleration[i];
      const double end = s.v(i) + 0.6 * 25e-6 * s.moment.link_acceleration[i];
      return only(i, start * end > 0.0 ? law(s) : s.moment.friction[i]);
    };
  };
  expect_law(
      on(1, "coulomb_friction", {{"level", 0.006}, {"asymmetry", -0.2}}),
      dry(1, [](const Seen& s) { return -0.006 * (1.0 - 0.2 * sign(s.v(1))) * sign(s.v(1)); }));
  expect_law(on(0, "stribeck_friction",
                {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.2}}),
             dry(0, [](const Seen& s) {
               return -(0.004 + 0.003 * std::exp(-s.v(0) * s.v(0) / 0.04)) * sign(s.v(0));
             }));
  expect_law(on(2, "oov_quadratic_drag", {{"coefficient", 0.02}}),
             [](const Seen& s) { return only(2, -0.02 * std::abs(s.v(2)) * s.v(2)); });
  expect_law(on(0, "oov_growing_friction", {{"level_at_end", 0.03}}),
             dry(0, [](const Seen& s) { return -0.03 * s.moment.t / 8.0 * sign(s.v(0)); }));
  expect_law(on(0, "oov_one_way_friction",
                {{"level", 0.004}, {"from_angle", 0.0}, {"to_angle", 0.1}, {"direction", 1.0}}),
             dry(0, [](const Seen& s) {
               const bool there = s.q(0) >= 0.0 && s.q(0) <= 0.1 && s.v(0) > 0.0;
               return there ? -0.004 : 0.0;
             }));
}

TEST(ConcealedLaws, OfSpringsWallsAndInertiasActOnTheLink) {
  expect_law(on(2, "cable_spring", {{"stiffness", 0.05}, {"rest_angle", 0.1}}),
             [](const Seen& s) { return only(2, -0.05 * (s.q(2) - 0.1)); });
  expect_law(on(2, "added_inertia", {{"inertia", 2e-4}}),
             [](const Seen& s) { return only(2, -2e-4 * s.moment.link_acceleration[2]); });
  expect_law(on(0, "contact",
                {{"location", -0.02}, {"stiffness", 5.0}, {"damping", 0.05}, {"side", -1.0}}),
             [](const Seen& s) {
               const double depth = -(s.q(0) + 0.02);
               return only(0, depth > 0.0 ? std::max(0.0, 5.0 * depth - 0.05 * s.v(0)) : 0.0);
             });
  expect_law(
      on(1, "oov_cross_coupling",
         {{"amplitude", 0.004}, {"from_axis", 1.0}, {"cycles_per_joint_rev", 9.0}, {"phase", 1.0}}),
      [](const Seen& s) { return only(1, 0.004 * std::sin(9.0 * s.q(0) + 1.0)); });
}

/// What a mass at the tool asks of the joints: Jᵀ m (a − g).
JointVector tool_mass(const Seen& s, double mass, double gravity) {
  const Plant::Motion& at = s.moment.at;
  const Vector3 a = linear_jacobian(phantom(), at.q) * s.moment.link_acceleration +
                    linear_jacobian_rate(phantom(), at.q, at.v) * at.v;
  return -mass * (linear_jacobian(phantom(), at.q).transpose() * (a + Vector3{0.0, gravity, 0.0}));
}

TEST(ConcealedLaws, OfLoadsAreThoseOfMassesAtTheTool) {
  expect_law(whole("payload", {{"mass", 0.02}}),
             [](const Seen& s) { return tool_mass(s, 0.02, kGravity); });
  expect_law(whole("hand_impedance", {{"stiffness", 6.0}, {"damping", 0.2}, {"mass", 0.01}}),
             [](const Seen& s) {
               const Plant::Motion& at = s.moment.at;
               const JointMatrix J = linear_jacobian(phantom(), at.q);
               const Vector3 off =
                   tool_position(phantom(), at.q) - tool_position(phantom(), {0.0, 0.40, 0.25});
               return JointVector{tool_mass(s, 0.01, 0.0) -
                                  J.transpose() * (6.0 * off + 0.2 * (J * at.v))};
             });
}

TEST(ConcealedLaws, OfATiltedBaseAreTheGradientOfItsWeight) {
  const double x = 0.2;
  const double z = -0.15;
  const Vector3 up{-std::sin(z), std::cos(z) * std::cos(x), std::cos(z) * std::sin(x)};
  const auto weight = [&](const JointVector& q, const Vector3& against) {
    const ArmModel::Lumped& body = phantom().lumped();
    const double forward = body.N2 * std::cos(q[1]) + body.N3 * std::sin(q[2]);
    const double height = body.N2 * std::sin(q[1]) - body.N3 * std::cos(q[2]);
    return against.dot(Vector3{std::sin(q[0]) * forward, height, std::cos(q[0]) * forward});
  };
  Plant plant = plant_with({whole("base_tilt", {{"tilt_x", x}, {"tilt_z", z}})});
  for (int tick = 0; tick < 500; ++tick) {
    const JointVector u = excitation(tick, plant.motion().q, plant.motion().v);
    plant.command(u);
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    const Plant::Motion& at = plant.last().at;
    const JointVector missing =
        inverse_dynamics(phantom(), at.q, at.v, plant.last().link_acceleration) - u;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const JointVector step = 1e-5 * JointVector::Unit(i);
      const auto slope = [&](const Vector3& against) {
        return (weight(at.q + step, against) - weight(at.q - step, against)) / 2e-5;
      };
      ASSERT_NEAR(missing[i], slope(Vector3::UnitY()) - slope(up), 1e-9);
    }
  }
}

TEST(ConcealedLaws, OfAComplianceTransmitTheTwist) {
  const double rotor = 1.8e-4;
  Plant plant =
      plant_with({on(0, "transmission_compliance", {{"stiffness", 40.0}, {"damping", 0.01}})});
  for (int tick = 0; tick < 1000; ++tick) {
    const JointVector u = excitation(tick, plant.motion().m, plant.motion().w);
    plant.command(u);
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    const Plant::Moment& last = plant.last();
    const double T = 40.0 * (last.at.m[0] - last.at.q[0]) + 0.01 * (last.at.w[0] - last.at.v[0]);
    ASSERT_NEAR(rotor * last.drive_acceleration[0], u[0] - T, 1e-12);
    const JointVector need =
        inverse_dynamics(phantom(), last.at.q, last.at.v, last.link_acceleration);
    ASSERT_NEAR(need[0] - rotor * last.link_acceleration[0], T, 1e-12);
  }
}

TEST(ConcealedLaws, OfDelayLagAndHeatHoldBetweenSamples) {
  constexpr double kSpan = 25e-6;
  // Impulse of a unit step that comes 2.31 ms late.
  Delivery late{{.delay = 2.31e-3}, 1e-3};
  Delivery lagging{{.lag = 1.7e-3}, 1e-3};
  Delivery heating{{.loss = 0.2, .heat_time = 0.1}, 1e-3};
  double impulse = 0.0;
  double lagged = 0.0;
  double hot = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    late.command(tick < 5 ? 0.0 : 1.0);
    lagging.command(tick < 5 ? 0.0 : 1.0);
    heating.command(0.03);
    for (int k = 0; k < 40; ++k) {
      const double t = 1e-3 * tick + kSpan * k;
      impulse += kSpan * late.mean(t, kSpan);
      lagged += kSpan * lagging.mean(t, kSpan);
      hot = heating.mean(t, kSpan);
    }
  }
  EXPECT_NEAR(impulse, 0.995 - 2.31e-3, 1e-9);
  EXPECT_NEAR(lagged, 0.995 - 1.7e-3, 1e-9);
  EXPECT_NEAR(hot, 0.03 * 0.8, 1e-5) << "the loss at 0.03 N m, ten time constants on";
  EXPECT_NEAR(heating.heat(), 1.0, 1e-4);
}

}  // namespace
}  // namespace teleop::concealed
