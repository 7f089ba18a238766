#include "scenarios/tune_theory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "core/effects/plant_spec.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

double parameter(const EffectSpec& effect, const std::string& name) {
  const auto found = effect.parameters.find(name);
  return found == effect.parameters.end() ? 0.0 : found->second;
}

LinearAxis::Config axis_of(const std::string& device, const TheoryAsk& ask, double frequency_Hz) {
  const std::size_t colon = device.find(':');
  const PlantSpec plant =
      load_plant(colon == std::string::npos ? "phantom-1.5" : device.substr(colon + 1));
  const ArmModel model = load_arm(plant.arm);
  const JointMatrix inverse = mass_matrix(model, ask.q).inverse();
  const JointVector Je =
      linear_jacobian(model, ask.q).row(static_cast<Eigen::Index>(ask.experiment.axis)).transpose();
  const double m = 1.0 / Je.dot(inverse * Je);
  // Joint speeds while the tool moves with amplitude A along the axis.
  const JointVector ratio = m * inverse * Je;
  const double tool_speed = 2.0 * std::numbers::pi * frequency_Hz * ask.amplitude_m;
  JointVector D = JointVector::Zero();
  for (const EffectSpec& effect : plant.effects) {
    const auto joint = static_cast<Eigen::Index>(effect.axis.value_or(0));
    if (effect.kind == "viscous_friction") D[joint] += parameter(effect, "coefficient");
    const double speed = std::abs(ratio[joint]) * tool_speed;
    if (effect.kind == "coulomb_friction" && speed > 0.0) {
      D[joint] += 4.0 * parameter(effect, "level") / (std::numbers::pi * speed);
    }
  }
  return {.mass_kg = m,
          .damping_Ns_per_m = ratio.dot(D.cwiseProduct(ratio)),
          .delay_s = plant.drive.delay_samples * ask.period_s};
}

}  // namespace

std::optional<AnalyticMargin> theory_of(const TheoryAsk& ask) {
  const bool simulated =
      std::all_of(ask.devices.begin(), ask.devices.end(),
                  [](const std::string& name) { return name.starts_with("sim"); });
  SampledLoop loop{.arms = {},
                   .stiffness_N_per_m = ask.experiment.stiffness_N_per_m,
                   .damping_Ns_per_m = ask.experiment.damping_Ns_per_m,
                   .velocity = ask.experiment.velocity,
                   .period_s = ask.period_s,
                   .peer_delay_samples = ask.experiment.peer_delay_samples};
  if (!simulated || !is_linear(loop)) return std::nullopt;
  const bool damps = ask.experiment.experiment == GainExperiment::damping;
  const TunedGain tuned = damps ? TunedGain::damping : TunedGain::stiffness;
  (damps ? loop.damping_Ns_per_m : loop.stiffness_N_per_m) = 0.0;
  // The frequency decides how much of Coulomb friction is felt, and the other way round.
  std::optional<AnalyticMargin> margin = AnalyticMargin{.gain = 0.0, .frequency_Hz = 30.0};
  for (int i = 0; i < 6 && margin; ++i) {
    loop.arms.clear();
    for (const std::string& device : ask.devices) {
      loop.arms.push_back(axis_of(device, ask, margin->frequency_Hz));
    }
    margin = nyquist_margin(loop, tuned);
  }
  return margin;
}

}  // namespace teleop
