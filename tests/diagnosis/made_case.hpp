#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/diagnosis/exact_reading.hpp"
#include "core/diagnosis/noise_model.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/math/random.hpp"
#include "core/model/arm_model.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"

namespace teleop::testing {

inline const ArmModel& phantom() {
  static const ArmModel arm = load_arm("phantom-1.5");
  return arm;
}

struct MadeCase {
  std::vector<EffectSpec> effects{};
  NoiseModel noise{};
  std::size_t runs = 3;
  double seconds = 2.0;
  std::uint64_t seed = 1;
};

/// Recordings of an arm that has these effects and shakes so, in closed loop, at 1 kHz.
inline DiagnosisCase make_case(const MadeCase& made) {
  const ArmModel& arm = phantom();
  const PlantTerms terms = terms_of(made.effects);
  const auto& counts = arm.parameters().encoder_counts_per_rev;
  DiagnosisCase data;
  data.name = "made";
  for (std::size_t i = 0; i < kJoints; ++i) {
    data.resolution[static_cast<Eigen::Index>(i)] = 2.0 * std::numbers::pi / counts.at(i);
  }
  for (std::size_t r = 0; r < made.runs; ++r) {
    Random random{made.seed * 1000 + r};
    const JointVector home{0.0, 0.4, 0.25};
    JointMatrix rate;
    JointMatrix phase;
    for (Eigen::Index i = 0; i < 9; ++i) {
      rate(i) = 2.0 * std::numbers::pi * std::exp(random.uniform(std::log(0.4), std::log(15.0)));
      phase(i) = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
    Plant plant{arm, {.terms = terms, .stops = false, .q = home}};
    ExactReading reading{terms, home, JointVector::Zero()};
    Recording run{.name = "run-0" + std::to_string(r + 1) + ".csv"};
    const JointVector memory =
        (-data.period_s * made.noise.time_constant.cwiseInverse()).array().exp();
    JointVector coloured = JointVector::Zero();
    JointVector last = home;
    JointVector speed = JointVector::Zero();
    const auto rows = static_cast<std::size_t>(made.seconds / data.period_s);
    for (std::size_t k = 0; k < rows; ++k) {
      const double t = static_cast<double>(k) * data.period_s;
      JointVector wanted = home;
      JointVector white;
      for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 3; ++j) {
          wanted[i] += 0.5 / rate(i, j) * std::sin(rate(i, j) * t + phase(i, j));
        }
        white[i] = made.noise.white[i] * random.normal();
        coloured[i] = memory[i] * coloured[i] + std::sqrt(1.0 - memory[i] * memory[i]) *
                                                    made.noise.coloured[i] * random.normal();
      }
      const JointVector sensed = reading.of(plant.drive_q());
      const JointVector q = data.resolution.cwiseProduct(
          (sensed.cwiseQuotient(data.resolution)).array().round().matrix());
      speed += 0.2 * ((q - last) / data.period_s - speed);
      last = q;
      const JointVector stiffness{1.5, 0.8, 0.3};
      const JointVector damping{0.02, 0.012, 0.005};
      JointVector tau =
          gravity_torque(arm, q) + stiffness.cwiseProduct(wanted - q) - damping.cwiseProduct(speed);
      tau = (tau / 1e-5).array().round().matrix() * 1e-5;
      run.q.push_back(q);
      run.tau.push_back(tau);
      plant.set_torque(tau);
      plant.set_disturbance(white + coloured);
      plant.advance(Duration{1'000'000}, reading.observer());
    }
    data.runs.push_back(std::move(run));
  }
  return data;
}

}  // namespace teleop::testing
