#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/effects/vocabulary.hpp"
#include "core/simulation/plant.hpp"
#include "core/simulation/sensing.hpp"
#include "scenarios/concealed/plant.hpp"
#include "scenarios/concealed/run.hpp"
#include "tests/concealed/loops.hpp"

namespace teleop::concealed {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::excitation;
using testing::on;
using testing::phantom;
using testing::whole;

PlantTerms terms(const std::vector<Effect>& effects) {
  std::vector<EffectSpec> specs;
  specs.reserve(effects.size());
  for (const Effect& effect : effects) {
    specs.push_back({.kind = effect.kind,
                     .axis = effect.axis,
                     .parameters = {effect.parameters.begin(), effect.parameters.end()}});
  }
  return terms_of(specs);
}

/// Largest difference of the two integrators' readings over a second in closed loop, in counts.
/// Each loop is closed on its own exact reading.
double difference(const std::vector<Effect>& effects) {
  const JointVector q{0.1, 0.45, 0.2};
  const JointVector v{0.2, -0.1, 0.15};
  const PlantTerms simulated = terms(effects);
  teleop::Plant theirs{phantom(), {.terms = simulated, .stops = false, .q = q, .qd = v}};
  const JointVector counts_per_rev{54476.8, 45875.2, 45875.2};
  Sensing sensing{simulated.sensing, counts_per_rev, q, v};
  Plant ours{plant_law(phantom(), effects, 1), q, v, 40};
  double largest = 0.0;
  JointVector before_theirs = sensing.exact_angles();
  JointVector before_ours = ours.reading();
  for (int tick = 0; tick < 1000; ++tick) {
    const JointVector y_theirs = sensing.exact_angles();
    const JointVector y_ours = ours.reading();
    const JointVector apart = (y_theirs - y_ours).cwiseQuotient(count_rad(phantom()));
    largest = std::max(largest, apart.cwiseAbs().maxCoeff());
    theirs.set_torque(excitation(tick, y_theirs, 1e3 * (y_theirs - before_theirs)));
    ours.command(excitation(tick, y_ours, 1e3 * (y_ours - before_ours)));
    before_theirs = y_theirs;
    before_ours = y_ours;
    theirs.advance(1ms, &sensing);
    ours.advance_half(JointVector::Zero());
    ours.advance_half(JointVector::Zero());
  }
  return largest;
}

TEST(ConcealedPlant, AgreesWithTheSimulatorWhereBothAreSmooth) {
  EXPECT_LT(difference({}), 0.01) << "nominal arm";
  const std::vector<Effect> smooth{
      on(0, "actuation_delay", {{"delay", 0.0023}}),
      on(1, "amplifier_lag", {{"time_constant", 0.003}}),
      on(2, "thermal_derating", {{"loss", 0.3}, {"time_constant", 0.3}}),
      on(0, "torque_ripple", {{"amplitude", 0.004}, {"period", 0.1}, {"phase", 0.4}}),
      on(1, "viscous_friction", {{"coefficient", 0.01}, {"asymmetry", 0.3}}),
      on(2, "presliding_hysteresis", {{"level", 0.003}, {"stiffness", 1.0}}),
      on(1, "transmission_compliance", {{"stiffness", 60.0}, {"damping", 0.02}}),
      on(1, "cable_spring", {{"stiffness", 0.05}, {"rest_angle", 0.1}}),
      on(2, "encoder_eccentricity",
         {{"amplitude", 0.002}, {"phase", 0.4}, {"cycles_per_joint_rev", 11.2}}),
      on(0, "sensor_delay", {{"delay", 0.0017}}),
      on(0, "contact", {{"location", 0.05}, {"stiffness", 5.0}, {"damping", 0.02}, {"side", 1.0}}),
      whole("payload", {{"mass", 0.01}}),
      whole("base_tilt", {{"tilt_x", 0.1}, {"tilt_z", -0.05}}),
      whole("hand_impedance", {{"stiffness", 10.0}, {"damping", 0.3}, {"mass", 0.02}}),
  };
  for (const Effect& effect : smooth) {
    EXPECT_LT(difference({effect}), 0.03) << effect.kind;
  }
}

TEST(ConcealedPlant, AgreesWithTheSimulatorWhereJointsStickAndPlay) {
  EXPECT_LT(difference({on(1, "coulomb_friction", {{"level", 0.006}, {"asymmetry", -0.2}})}), 0.3);
  EXPECT_LT(difference({on(2, "stribeck_friction",
                           {{"coulomb", 0.002}, {"static", 0.004}, {"stribeck_velocity", 0.05}})}),
            0.3);
  EXPECT_LT(difference({on(1, "backlash", {{"gap", 0.0008}})}), 0.5);
}

}  // namespace
}  // namespace teleop::concealed
