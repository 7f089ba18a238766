#include "scenarios/concealed/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "scenarios/concealed/run.hpp"
#include "tests/concealed/loops.hpp"

namespace teleop::concealed {
namespace {

using testing::excitation;
using testing::on;
using testing::phantom;
using testing::plant_with;
using testing::whole;

/// Largest departure of two loops from each other over 8 s, in counts.
double departure(int substeps, int finer) {
  Plant a = plant_with({}, substeps);
  Plant b = plant_with({}, finer);
  double largest = 0.0;
  for (int tick = 0; tick < 8000; ++tick) {
    for (Plant* plant : {&a, &b}) {
      plant->command(excitation(tick, plant->motion().q, plant->motion().v));
      plant->advance_half({1e-4, -1e-4, 5e-5});
      plant->advance_half({-2e-4, 1e-4, 5e-5});
    }
    const JointVector counts = (a.reading() - b.reading()).cwiseQuotient(count_rad(phantom()));
    largest = std::max(largest, counts.cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(ConcealedPlant, HalvingTheStepMovesReadingsByFarLessThanACount) {
  const double at_40 = departure(40, 80);
  EXPECT_LT(at_40, 0.02);
  EXPECT_NEAR(departure(20, 40) / at_40, 4.0, 1.0) << "the scheme is of order two";
}

TEST(ConcealedPlant, AJointThatFrictionHoldsStaysExactly) {
  Plant plant = plant_with({on(0, "coulomb_friction", {{"level", 0.01}, {"asymmetry", 0.0}}),
                            on(1, "coulomb_friction", {{"level", 0.5}, {"asymmetry", 0.0}}),
                            on(2, "coulomb_friction", {{"level", 0.5}, {"asymmetry", 0.0}})},
                           40, JointVector::Zero());
  const JointVector start = plant.motion().q;
  for (int tick = 0; tick < 8000; ++tick) {
    plant.command({0.0099 * std::sin(0.03 * tick), 0.1, -0.1});
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    ASSERT_EQ(plant.motion().q, start) << tick;
  }
  plant.command({0.0101, 0.0, 0.0});
  plant.advance_half(JointVector::Zero());
  EXPECT_GT(plant.motion().q[0], start[0]) << "beyond its level it gives way";
}

TEST(ConcealedPlant, AStuckJointNeedsTheStaticLevelToComeLoose) {
  Plant plant =
      plant_with({on(0, "stribeck_friction",
                     {{"coulomb", 0.004}, {"static", 0.007}, {"stribeck_velocity", 0.02}}),
                  on(1, "coulomb_friction", {{"level", 0.5}, {"asymmetry", 0.0}}),
                  on(2, "coulomb_friction", {{"level", 0.5}, {"asymmetry", 0.0}})},
                 40, JointVector::Zero());
  const auto push = [&](double u, int ticks) {
    for (int k = 0; k < ticks; ++k) {
      plant.command({u, 0.0, 0.0});
      plant.advance_half(JointVector::Zero());
      plant.advance_half(JointVector::Zero());
    }
  };
  push(0.0069, 100);
  EXPECT_EQ(plant.motion().v[0], 0.0);
  push(0.0072, 300);
  const double M11 = mass_matrix(phantom(), plant.motion().q)(0, 0);
  EXPECT_GT(plant.motion().v[0], 0.5 * 0.3 * 0.0032 / M11) << "once loose it needs less";
}

TEST(ConcealedPlant, PassiveEffectsAddNoEnergy) {
  const std::vector<Effect> passive{
      on(0, "viscous_friction", {{"coefficient", 0.003}, {"asymmetry", 0.4}}),
      on(1, "coulomb_friction", {{"level", 0.004}, {"asymmetry", -0.3}}),
      on(2, "stribeck_friction",
         {{"coulomb", 0.002}, {"static", 0.004}, {"stribeck_velocity", 0.05}}),
      on(1, "presliding_hysteresis", {{"level", 0.004}, {"stiffness", 2.0}}),
      on(2, "backlash", {{"gap", 0.004}}),
      on(1, "transmission_compliance", {{"stiffness", 60.0}, {"damping", 0.01}}),
      on(1, "cable_spring", {{"stiffness", 0.3}, {"rest_angle", 0.4}}),
      on(0, "contact", {{"location", 0.2}, {"stiffness", 20.0}, {"damping", 0.02}, {"side", 1.0}}),
      on(0, "added_inertia", {{"inertia", 3e-4}}),
      whole("payload", {{"mass", 0.02}}),
      whole("base_tilt", {{"tilt_x", 0.2}, {"tilt_z", -0.1}}),
      whole("hand_impedance", {{"stiffness", 30.0}, {"damping", 0.4}, {"mass", 0.03}}),
      on(1, "oov_quadratic_drag", {{"coefficient", 0.003}}),
      on(0, "oov_growing_friction", {{"level_at_end", 0.02}}),
      on(2, "oov_link_resonance", {{"inertia", 1e-4}, {"stiffness", 5.0}, {"damping", 1e-3}}),
  };
  for (const Effect& effect : passive) {
    Plant plant = plant_with({effect}, 40, {2.0, -1.0, 1.5});
    plant.command(JointVector::Zero());
    double lowest = plant.energy();
    for (int tick = 0; tick < 400; ++tick) {
      plant.advance_half(JointVector::Zero());
      plant.advance_half(JointVector::Zero());
      const double now = plant.energy();
      ASSERT_LT(now, lowest + 1e-6) << effect.kind << " at " << tick << " ms";
      lowest = std::min(lowest, now);
    }
  }
}

TEST(ConcealedPlant, PlayKeepsItsWidthPushesOnlyAndLeavesTheSumOfTorquesAlone) {
  const double gap = 0.003;
  const double rotor = 1.25e-4;
  Plant plant = plant_with({on(1, "backlash", {{"gap", gap}})});
  int open = 0;
  int closed = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const JointVector u = excitation(tick, plant.motion().m, plant.motion().w);
    plant.command(u);
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    const Plant::Motion& now = plant.motion();
    ASSERT_LE(std::abs(now.m[1] - now.q[1]), gap / 2.0 + 1e-12);
    const Plant::Moment& last = plant.last();
    const JointVector need =
        inverse_dynamics(phantom(), last.at.q, last.at.v, last.link_acceleration);
    const double sum =
        need[1] - rotor * last.link_acceleration[1] + rotor * last.drive_acceleration[1];
    ASSERT_NEAR(sum, u[1], 1e-11) << "a locked transmission gives back the nominal arm";
    const double T = u[1] - rotor * last.drive_acceleration[1];
    if (plant.open(1)) {
      ++open;
      ASSERT_NEAR(T, 0.0, 1e-12);
    } else {
      ++closed;
      ASSERT_GE(T * (now.m[1] - now.q[1]), -1e-12) << "pushing only";
    }
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(closed, 100);
}

TEST(ConcealedPlant, ABristleFollowsDahlsLawAlongOneDirection) {
  const double level = 0.005;
  const double stiffness = 0.8;
  Plant plant =
      plant_with({on(0, "presliding_hysteresis", {{"level", level}, {"stiffness", stiffness}})}, 40,
                 {0.05, 0.0, 0.0});
  const double start = plant.motion().m[0];
  for (int tick = 0; tick < 200; ++tick) {
    plant.command({0.008, 0.0, 0.0});
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    const double x = plant.last().at.m[0] - start;
    ASSERT_NEAR(plant.last().friction[0], -level * (1.0 - std::exp(-stiffness * x / level)), 1e-12);
  }
}

TEST(ConcealedPlant, ReadingsFollowTheirDefinitions) {
  Plant plant =
      plant_with({on(0, "encoder_scale", {{"scale", 1.03}}),
                  on(1, "encoder_eccentricity",
                     {{"amplitude", 0.002}, {"phase", 0.4}, {"cycles_per_joint_rev", 11.2}}),
                  on(2, "sensor_delay", {{"delay", 0.0023}})});
  const Plant::Motion start = plant.motion();
  EXPECT_NEAR(plant.reading()[2], start.m[2] - 0.0023 * start.w[2], 1e-12)
      << "before the start it moved uniformly";
  std::vector<double> m{start.m[2]};
  for (int tick = 0; tick < 500; ++tick) {
    const JointVector y = plant.reading();
    const JointVector& now = plant.motion().m;
    ASSERT_NEAR(y[0], 1.03 * now[0], 1e-14);
    ASSERT_NEAR(y[1], now[1] + 0.002 * std::sin(11.2 * now[1] + 0.4), 1e-14);
    if (tick > 3) {
      const auto k = static_cast<std::size_t>(tick);
      const double between = m[k - 3] + 0.7 * (m[k - 2] - m[k - 3]);
      ASSERT_NEAR(y[2], between, 2e-5) << "within the bend of a millisecond";
    }
    plant.command(excitation(tick, plant.motion().q, plant.motion().v));
    plant.advance_half(JointVector::Zero());
    plant.advance_half(JointVector::Zero());
    m.push_back(plant.motion().m[2]);
  }
}

TEST(ConcealedPlant, AWrongTimeBaseStretchesTheSample) {
  Plant plant = plant_with({whole("time_base", {{"ratio", 1.02}})});
  plant.command(JointVector::Zero());
  plant.advance_half(JointVector::Zero());
  plant.advance_half(JointVector::Zero());
  EXPECT_NEAR(plant.time(), 1.02e-3, 1e-15);
}

}  // namespace
}  // namespace teleop::concealed
