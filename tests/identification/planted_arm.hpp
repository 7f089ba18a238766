#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/identification/mechanical_form.hpp"
#include "core/identification/response_experiment.hpp"
#include "core/math/random.hpp"
#include "core/simulation/linear_arm.hpp"
#include "tests/identification/plants.hpp"

namespace teleop::testing {

/// A linear arm with a known mechanism on one axis, measured as the verb would measure it.
struct PlantedArm {
  MechanicalForm form = MechanicalForm::a;
  MechanicalParameters truth;
  std::size_t axis = 0;
  LinearArm::Config config{};

  /// Form and axis by turns; encoder between half and one and a half times a PHANToM's 30 µm.
  explicit PlantedArm(std::uint64_t seed, double coulomb_N = 0.0) {
    Random random{seed};
    form = seed % 2 == 0 ? MechanicalForm::a : MechanicalForm::b;
    axis = seed / 2 % 3;
    truth = random_mechanism(form, random);
    for (LinearAxis::Config& other : config.axes) {
      other.damping_Ns_per_m = 0.0;
    }
    config.axes.at(axis) = {.mass_kg = truth.m1_kg,
                            .damping_Ns_per_m = 0.0,
                            .second_mass_kg = truth.m2_kg,
                            .joint_N_per_m = truth.k_N_per_m,
                            .joint_damping_Ns_per_m = truth.b_Ns_per_m,
                            .tendon_N_per_m = truth.k_t_N_per_m,
                            .coulomb_N = coulomb_N};
    config.quantum_m = random.uniform(15e-6, 45e-6);
    config.noise_std_m = random.uniform(1e-6, 10e-6);
    config.seed = seed;
  }

  [[nodiscard]] Eigen::VectorXd true_values() const {
    return MechanicalFamily{.form = form}.pack(truth).array().exp();
  }
};

inline ResponseMeasurement measure(const PlantedArm& planted, ResponseExperiment experiment) {
  static const ArmModel model = load_arm("phantom-1.5");
  SimulatedClock clock;
  LinearArm arm{planted.config, clock};
  experiment.axis = planted.axis;
  const std::atomic<bool> stop{false};
  return measure_response(experiment, arm, model, clock, stop);
}

}  // namespace teleop::testing
