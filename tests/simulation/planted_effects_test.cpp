#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/effects/vocabulary.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"
#include "core/simulation/sensing.hpp"
#include "tests/simulation/effect_cases.hpp"
#include "tests/simulation/plants.hpp"
#include "tests/support/no_allocation.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only
using testing::Channel;
using testing::effect_cases;
using testing::EffectCase;
using testing::phantom;

const JointVector kCounts{54476.8, 45875.2, 45875.2};

/// A torque that moves all joints about, held in place by a weak spring.
JointVector excitation(const Plant& plant, int tick) {
  const double t = 1e-3 * tick;
  const JointVector push{0.03 * std::sin(9.0 * t) + 0.01 * std::sin(61.0 * t),
                         0.03 * std::sin(8.0 * t + 1.0) + 0.008 * std::sin(83.0 * t),
                         0.02 * std::sin(10.0 * t + 2.0) + 0.006 * std::sin(71.0 * t)};
  return push + gravity_torque(phantom(), plant.q()) -
         JointVector{0.2, 0.3, 0.3}.cwiseProduct(plant.q() - JointVector{0.0, 0.05, 0.02}) -
         0.008 * plant.qd();
}

/// RMS of what differs from the ideal arm, by place and axis.
struct Signature {
  JointVector actuation = JointVector::Zero();  ///< delivered less commanded torque
  JointVector joint = JointVector::Zero();      ///< what the rigid body needs less delivered torque
  JointVector sensing = JointVector::Zero();    ///< exact reading less angle of the drive
  JointVector edges = JointVector::Zero();      ///< counted less exact reading, beyond half a count
};

Signature signature_of(const std::vector<EffectSpec>& effects) {
  const PlantTerms terms = terms_of(effects);
  Plant plant{phantom(), {.terms = terms, .q = {0.0, 0.05, 0.02}}};
  Sensing sensing{terms.sensing, kCounts, plant.q()};
  Signature sum;
  static constexpr int kTicks = 3000;
  for (int tick = 0; tick < kTicks; ++tick) {
    const JointVector u = excitation(plant, tick);
    plant.set_torque(u);
    plant.advance(700us, &sensing);
    const auto square = [](const JointVector& x) -> JointVector {
      return x.cwiseProduct(x);
    };
    const JointVector a = plant.delivered_torque();
    sum.actuation += square(a - u);
    sum.joint += square(inverse_dynamics(phantom(), plant.q(), plant.qd(), plant.qdd()) - a);
    sum.sensing += square(sensing.exact_angles() - plant.drive_q());
    const JointVector off = sensing.angles() - sensing.exact_angles();
    const JointVector half = std::numbers::pi * sensing.counts_per_rev().cwiseInverse();
    sum.edges += square((off.cwiseAbs() - 1.000001 * half).cwiseMax(0.0));
    plant.advance(300us, &sensing);
  }
  const auto root = [](JointVector& x) {
    x = (x / kTicks).cwiseSqrt();
  };
  root(sum.actuation);
  root(sum.joint);
  root(sum.sensing);
  root(sum.edges);
  return sum;
}

constexpr double kTorque = 1e-9;  // N m, rounding of torques
constexpr double kAngle = 1e-12;  // rad, rounding of angles

bool needs_company(const std::string& kind) { return kind == "brush_commutation"; }

TEST(PlantedEffects, AppearWhereTheyActAndNowhereElse) {
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    for (const EffectCase& each : effect_cases(axis)) {
      SCOPED_TRACE(each.effect.kind + " on axis " + std::to_string(axis + 1));
      if (needs_company(each.effect.kind)) continue;
      const Signature seen = signature_of({each.effect});
      for (std::size_t i = 0; i < kJoints; ++i) {
        const auto joint = static_cast<Eigen::Index>(i);
        const bool here = i == axis;
        if (each.channel == Channel::actuation && here) {
          EXPECT_GT(seen.actuation[joint], 1e-6);
        } else {
          EXPECT_LT(seen.actuation[joint], kTorque) << "axis " << i + 1;
        }
        if (each.channel == Channel::joint && here) {
          EXPECT_GT(seen.joint[joint], 1e-4);
        } else if (each.channel != Channel::whole_arm) {
          EXPECT_LT(seen.joint[joint], kTorque) << "axis " << i + 1;
        }
        const bool read = each.channel == Channel::sensing && here && each.effect.axis;
        if (read && each.effect.kind == "quadrature_error") {
          EXPECT_GT(seen.edges[joint], 1e-6);
        } else if (read) {
          EXPECT_GT(seen.sensing[joint], 1e-7);
        } else {
          EXPECT_LT(seen.sensing[joint], kAngle) << "axis " << i + 1;
          EXPECT_EQ(seen.edges[joint], 0.0) << "axis " << i + 1;
        }
      }
      if (each.channel == Channel::whole_arm) {
        EXPECT_GT(seen.joint.norm(), 1e-3);
      }
    }
  }
}

TEST(PlantedEffects, CoverEveryKindOfTheVocabulary) {
  std::set<std::string> kinds;
  for (const EffectCase& each : effect_cases(0)) {
    kinds.insert(each.effect.kind);
  }
  for (const EffectKind* kind : vocabulary()) {
    EXPECT_EQ(kinds.count(std::string{kind->name}), 1U) << kind->name;
  }
}

TEST(PlantedEffects, AddNoEnergyAtAnyStepWhereTheyArePassive) {
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    for (const EffectCase& each : effect_cases(axis)) {
      if (!each.passive) continue;
      SCOPED_TRACE(each.effect.kind + " on axis " + std::to_string(axis + 1));
      for (const double speed : {0.3, 3.0}) {
        const std::vector effects{each.effect};
        Plant plant{phantom(),
                    {.terms = terms_of(effects), .qd = JointVector{speed, -speed, 0.7 * speed}}};
        double before = plant.energy();
        const double scale = std::abs(before) + 1e-3;
        for (int tick = 0; tick < 4000; ++tick) {
          plant.advance(100us);
          const double now = plant.energy();
          ASSERT_LT(now, before + 1e-9 * scale) << "at " << tick * 1e-4 << " s, speed " << speed;
          before = now;
        }
      }
    }
  }
}

TEST(PlantedEffects, AgreeWithThemselvesAtHalfTheStep) {
  for (const EffectCase& each : effect_cases(1)) {
    SCOPED_TRACE(each.effect.kind);
    const std::vector effects{each.effect};
    const auto end_of = [&](Duration step) {
      const PlantTerms terms = terms_of(effects);
      Plant plant{phantom(), {.terms = terms, .max_step = step, .q = {0.0, 0.05, 0.02}}};
      JointVector push = JointVector::Zero();
      for (int tick = 0; tick < 1000; ++tick) {
        const double t = 1e-3 * tick;
        push = {0.03 * std::sin(9.0 * t), 0.03 * std::sin(8.0 * t + 1.0),
                0.02 * std::sin(10.0 * t + 2.0)};
        plant.set_torque(push);
        plant.advance(1ms);
      }
      return plant.q();
    };
    EXPECT_LT((end_of(1ms) - end_of(500us)).norm(), 0.01 * testing::kCount);
  }
}

TEST(PlantedEffects, AllTogetherNeitherAllocateNorLoseTheirWay) {
  if (!testing::NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  std::vector<EffectSpec> effects;
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    for (const EffectCase& each : effect_cases(axis)) {
      const bool again = !each.effect.axis && axis > 0;
      const bool other = each.effect.kind == "pwm_drive" || each.effect.kind == "lugre_friction" ||
                         (each.effect.kind == "backlash" && axis != 1) ||
                         (each.effect.kind == "transmission_compliance" && axis == 1);
      if (!again && !other) effects.push_back(each.effect);
    }
  }
  const PlantTerms terms = terms_of(effects);
  Plant plant{phantom(), {.terms = terms, .q = {0.0, 0.05, 0.02}}};
  Sensing sensing{terms.sensing, kCounts, plant.q()};
  const testing::NoAllocation guard;
  for (int tick = 0; tick < 2000; ++tick) {
    plant.set_torque(excitation(plant, tick));
    plant.advance(1ms, &sensing);
  }
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_TRUE(plant.q().allFinite());
  EXPECT_LT(plant.q().norm(), 2.0);
}

}  // namespace
}  // namespace teleop
