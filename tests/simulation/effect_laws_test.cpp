#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/effects/vocabulary.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "core/simulation/plant.hpp"
#include "core/simulation/sensing.hpp"
#include "tests/simulation/plants.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::phantom;
using Values = std::map<std::string, double>;

EffectSpec on(std::size_t axis, const char* kind, const Values& values) {
  return {.kind = kind, .axis = axis, .parameters = values};
}
EffectSpec whole(const char* kind, const Values& values) {
  return {.kind = kind, .axis = std::nullopt, .parameters = values};
}

JointVector excitation(const Plant& plant, int tick) {
  const double t = 1e-3 * tick;
  const JointVector push{0.03 * std::sin(9.0 * t) + 0.01 * std::sin(61.0 * t),
                         0.03 * std::sin(8.0 * t + 1.0) + 0.008 * std::sin(83.0 * t),
                         0.02 * std::sin(10.0 * t + 2.0) + 0.006 * std::sin(71.0 * t)};
  return push + gravity_torque(phantom(), plant.q()) - 0.2 * plant.q() - 0.01 * plant.qd();
}

/// What the ideal arm lacks to move as it does, N m.
JointVector missing_torque(Plant& plant) {
  return inverse_dynamics(phantom(), plant.q(), plant.qd(), plant.qdd()) - plant.delivered_torque();
}

using Law = std::function<JointVector(Plant&)>;

void expect_law(const EffectSpec& effect, const Law& law) {
  SCOPED_TRACE(effect.kind);
  const std::vector effects{effect};
  Plant plant{phantom(), {.terms = terms_of(effects), .q = {0.1, 0.05, 0.02}}};
  double largest = 0.0;
  for (int tick = 0; tick < 1500; ++tick) {
    plant.set_torque(excitation(plant, tick));
    plant.advance(1ms);
    const JointVector expected = law(plant);
    ASSERT_LT((missing_torque(plant) - expected).norm(), 1e-10) << "at " << tick << " ms";
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 1e-4);
}

double sign(double x) { return x > 0.0 ? 1.0 : -1.0; }

TEST(EffectLaws, OfFrictionHoldWhereTheJointSlides) {
  const auto only = [](Eigen::Index axis, double torque) {
    JointVector result = JointVector::Zero();
    result[axis] = torque;
    return result;
  };
  expect_law(on(1, "viscous_friction", {{"coefficient", 0.01}, {"asymmetry", 0.3}}),
             [&](Plant& p) { return only(1, -0.01 * (1.0 + 0.3 * sign(p.qd()[1])) * p.qd()[1]); });
  expect_law(on(1, "coulomb_friction", {{"level", 0.006}, {"asymmetry", -0.2}}), [&](Plant& p) {
    const bool stuck = p.sliding()[1] == Sliding::stuck;
    const double s = sign(p.qd()[1]);
    return only(1, stuck ? missing_torque(p)[1] : -0.006 * (1.0 - 0.2 * s) * s);
  });
  expect_law(on(0, "stribeck_friction",
                {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.2}}),
             [&](Plant& p) {
               const bool stuck = p.sliding()[0] == Sliding::stuck;
               const double v = p.qd()[0];
               const double level = 0.004 + 0.003 * std::exp(-v * v / 0.04);
               return only(0, stuck ? missing_torque(p)[0] : -level * sign(v));
             });
  expect_law(on(2, "cable_spring", {{"stiffness", 0.05}, {"rest_angle", 0.1}}),
             [&](Plant& p) { return only(2, -0.05 * (p.q()[2] - 0.1)); });
  expect_law(on(2, "added_inertia", {{"inertia", 2e-4}}),
             [&](Plant& p) { return only(2, -2e-4 * p.qdd()[2]); });
  expect_law(
      on(0, "contact", {{"location", -0.02}, {"stiffness", 20.0}, {"damping", 0.05}, {"side", -1}}),
      [&](Plant& p) {
        const double depth = -(p.q()[0] + 0.02);
        const double push = std::max(0.0, 20.0 * depth - 0.05 * p.qd()[0]);
        return only(0, depth > 0.0 ? push : 0.0);
      });
}

TEST(EffectLaws, OfStuckJointsKeepToTheStaticLevel) {
  const std::vector effects{
      on(0, "stribeck_friction",
         {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.05}})};
  Plant plant{phantom(), {.terms = terms_of(effects)}};
  plant.set_torque({0.00699, 0.0, 0.0});
  plant.advance(50ms);
  EXPECT_EQ(plant.q()[0], 0.0);
  plant.set_torque({0.0072, 0.0, 0.0});
  plant.advance(10ms);
  EXPECT_GT(plant.qd()[0], 0.0);
  plant.advance(500ms);
  const double M11 = mass_matrix(phantom(), JointVector::Zero())(0, 0);
  EXPECT_GT(plant.qd()[0], 0.3 * 0.003 / M11) << "once loose it needs less";
}

/// What a mass m at the tool asks of the joints: Jᵀ m (a − g).
JointVector tool_mass_torque(Plant& plant, double mass, double gravity) {
  const Vector3 asks = plant.tool_acceleration() + Vector3{0.0, gravity, 0.0};
  return -mass * (linear_jacobian(phantom(), plant.q()).transpose() * asks);
}

TEST(EffectLaws, OfLoadsAreThoseOfMassesAtTheTool) {
  expect_law(whole("payload", {{"mass", 0.02}}),
             [](Plant& p) { return tool_mass_torque(p, 0.02, 9.81); });
  const Vector3 grip = tool_position(phantom(), {0.0, 0.40, 0.25});
  expect_law(whole("hand_impedance", {{"stiffness", 100.0}, {"damping", 2.0}, {"mass", 0.03}}),
             [&](Plant& p) -> JointVector {
               const auto J = linear_jacobian(phantom(), p.q());
               const Vector3 pull =
                   100.0 * (grip - tool_position(phantom(), p.q())) - 2.0 * (J * p.qd());
               return J.transpose() * pull + tool_mass_torque(p, 0.03, 0.0);
             });
}

TEST(EffectLaws, OfATiltedBaseTurnTheWeight) {
  // About z by a right angle, "up" is −x: weight then pulls along +x.
  constexpr double kAngle = 0.3;
  expect_law(
      whole("base_tilt", {{"tilt_x", 0.0}, {"tilt_z", kAngle}}), [](Plant& p) -> JointVector {
        const auto& lumped = phantom().lumped();
        const JointVector& q = p.q();
        const double reach = lumped.N2 * std::cos(q[1]) + lumped.N3 * std::sin(q[2]);
        const JointVector upright{0.0, lumped.N2 * std::cos(q[1]), lumped.N3 * std::sin(q[2])};
        const double up_x = -std::sin(kAngle);
        const double up_y = std::cos(kAngle);
        const JointVector tilted{
            up_x * std::cos(q[0]) * reach,
            up_y * upright[1] - up_x * std::sin(q[0]) * lumped.N2 * std::sin(q[1]),
            up_y * upright[2] + up_x * std::sin(q[0]) * lumped.N3 * std::cos(q[2])};
        return upright - tilted;
      });
}

TEST(EffectLaws, OfDahlIsTheSolutionOfItsEquation) {
  const std::vector effects{on(0, "presliding_hysteresis", {{"level", 0.006}, {"stiffness", 3.0}})};
  Plant plant{phantom(), {.terms = terms_of(effects)}};
  double z = 0.0;
  double worst = 0.0;
  for (int step = 0; step < 200'000; ++step) {
    if (step % 100 == 0) {
      plant.set_torque({0.01 * std::sin(0.02 * step / 100.0), 0.0, 0.0});
      worst = std::max(worst, std::abs(missing_torque(plant)[0] + z));
    }
    const double before = plant.q()[0];
    plant.advance(10us);
    const double turn = plant.q()[0] - before;
    const double middle = z + 1.5 * (turn - std::abs(turn) * z / 0.006);  // explicit midpoint
    z += 3.0 * (turn - std::abs(turn) * middle / 0.006);
  }
  EXPECT_LT(worst, 1e-7);
  EXPECT_GT(std::abs(plant.q()[0]), 1e-3);
}

TEST(EffectLaws, OfAFractionalDelayShiftTheCommandToTheInstant) {
  const std::vector effects{on(0, "actuation_delay", {{"delay", 0.0023}})};
  Plant plant{phantom(), {.terms = terms_of(effects)}};
  const auto command = [](int tick) {
    return tick < 0 ? 0.0 : 0.001 * (tick * tick % 17);
  };
  for (int tick = 0; tick < 200; ++tick) {
    plant.set_torque({command(tick), 0.0, 0.0});
    plant.advance(299us);
    EXPECT_EQ(plant.delivered_torque()[0], command(tick - 3)) << tick;
    plant.advance(2us);
    EXPECT_EQ(plant.delivered_torque()[0], command(tick - 2)) << tick;
    plant.advance(699us);
  }
}

TEST(EffectLaws, OfTheActuationChainHoldInTheirOrder) {
  const Values heat{{"loss", 0.2}, {"time_constant", 0.05}};
  const std::vector effects{on(0, "torque_saturation", {{"limit", 0.05}}),
                            on(0, "torque_deadzone", {{"threshold", 0.004}}),
                            on(0, "torque_gain", {{"gain", 0.9}}),
                            on(0, "thermal_derating", heat),
                            on(0, "amplifier_lag", {{"time_constant", 0.0013}}),
                            on(0, "torque_bias", {{"bias", 0.003}}),
                            on(0, "axis_coupling", {{"fraction", 0.1}, {"from_axis", 2}})};
  Plant plant{phantom(), {.terms = terms_of(effects)}};
  double H = 0.0;
  double a = 0.0;
  double worst = 0.0;
  double hottest = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    const double u = 0.08 * std::sin(0.03 * tick);
    const double other = 0.02 * std::cos(0.05 * tick);
    plant.set_torque({u, other, 0.0});
    const double cut = std::clamp(u, -0.05, 0.05);
    const double live = std::abs(cut) <= 0.004 ? 0.0 : cut - 0.004 * sign(cut);
    if (tick == 0) a = 0.9 * live;
    constexpr int kFine = 1000;
    for (int k = 0; k < kFine; ++k) {  // explicit midpoint
      constexpr double h = 1e-3 / kFine;
      const double power = live * live / (0.03 * 0.03);
      const double H_mid = H + h / 2.0 * (power - H) / 0.05;
      const double out = 0.9 * std::max(0.2, 1.0 - 0.2 * H_mid) * live;
      a += h * (out - (a + h / 2.0 * (out - a) / 0.0013)) / 0.0013;
      H += h * (power - H_mid) / 0.05;
    }
    hottest = std::max(hottest, H);
    plant.advance(1ms);
    worst = std::max(worst, std::abs(plant.delivered_torque()[0] - (a + 0.003 + 0.1 * other)));
  }
  EXPECT_LT(worst, 2e-6);
  EXPECT_GT(0.2 * hottest, 0.4) << "much of the torque should be lost at times";
}

TEST(EffectLaws, OfThermalLossStopAtAFifthOfTheTorque) {
  const std::vector effects{on(0, "thermal_derating", {{"loss", 0.5}, {"time_constant", 0.1}})};
  Plant plant{phantom(), {.terms = terms_of(effects), .stops = false}};
  plant.set_torque({0.06, 0.0, 0.0});  // H goes to 4, the loss would be 2
  const double reaches = -0.1 * std::log(1.0 - 1.6 / 4.0);
  plant.advance(Duration{static_cast<std::int64_t>(1e9 * (reaches - 1e-4))});
  EXPECT_GT(plant.delivered_torque()[0], 0.2 * 0.06 + 1e-6);
  plant.advance(200us);
  EXPECT_DOUBLE_EQ(plant.delivered_torque()[0], 0.2 * 0.06);
  plant.set_torque({0.02, 0.0, 0.0});
  plant.advance(10s);
  const double H = 0.02 * 0.02 / (0.03 * 0.03);
  EXPECT_NEAR(plant.delivered_torque()[0], 0.02 * (1.0 - 0.5 * H), 1e-12);
}

TEST(EffectLaws, OfACompliantTransmissionGiveTheResonanceOfTwoMasses) {
  constexpr double kStiffness = 40.0;
  const std::vector effects{
      on(0, "transmission_compliance", {{"stiffness", kStiffness}, {"damping", 0.0}})};
  PlantTerms terms = terms_of(effects);
  terms.friction[1] = terms.friction[2] = {.dry_forward = 10.0, .dry_backward = 10.0};
  Plant plant{phantom(), {.terms = terms, .stops = false}};
  plant.set_torque({0.05, 0.0, 0.0});
  plant.advance(500us);
  plant.set_torque(JointVector::Zero());
  const double J = 1.8e-4;
  const double M11 = mass_matrix(phantom(), JointVector::Zero())(0, 0);
  const double resonance = std::sqrt(kStiffness * (1.0 / J + 1.0 / (M11 - J)));
  double last = plant.drive_q()[0] - plant.q()[0];
  std::vector<double> crossings;
  constexpr double kStep = 10e-6;
  for (int k = 0; crossings.size() < 41; ++k) {
    plant.advance(10us);
    const double twist = plant.drive_q()[0] - plant.q()[0];
    if (last > 0.0 && twist <= 0.0) crossings.push_back((k + last / (last - twist)) * kStep);
    last = twist;
  }
  const double measured = 2.0 * std::numbers::pi * 40.0 / (crossings.back() - crossings.front());
  EXPECT_NEAR(measured / resonance, 1.0, 1e-4);
}

TEST(EffectLaws, OfPlayKeepToTheGapAndTheMomentum) {
  constexpr double kGap = 0.01;
  constexpr double J = 1.8e-4;
  const std::vector effects{on(0, "backlash", {{"gap", kGap}})};
  const double M11 = mass_matrix(phantom(), JointVector::Zero())(0, 0);
  Plant plant{phantom(), {.terms = terms_of(effects), .stops = false}};
  plant.set_torque({0.004, 0.0, 0.0});
  // The drive alone crosses half the gap, then both go on with the momentum that it had.
  const double crossing = std::sqrt(kGap * J / 0.004);
  plant.advance(Duration{static_cast<std::int64_t>(1e9 * crossing) - 1000});
  EXPECT_NEAR(plant.drive_qd()[0], 0.004 / J * crossing, 1e-3);
  EXPECT_EQ(plant.qd()[0], 0.0);
  const double momentum = J * plant.drive_qd()[0];
  plant.advance(2us);
  EXPECT_NEAR(plant.qd()[0] * M11, momentum, 1e-3 * momentum);
  EXPECT_EQ(plant.qd()[0], plant.drive_qd()[0]);
  double widest = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    plant.set_torque({0.02 * std::sin(0.05 * tick), 0.0, 0.0});
    plant.advance(1ms);
    widest = std::max(widest, std::abs(plant.drive_q()[0] - plant.q()[0]));
  }
  EXPECT_LE(widest, kGap / 2.0 * (1.0 + 1e-9));
  EXPECT_GT(widest, kGap / 2.0 * (1.0 - 1e-9));
}

}  // namespace
}  // namespace teleop
