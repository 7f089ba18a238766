#include "scenarios/concealed/effect_draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace teleop::concealed {
namespace {

using std::numbers::pi;

constexpr std::array kMiddle{0.0, 0.40, 0.25};
constexpr std::array kRotor{1.8e-4, 1.25e-4, 1.25e-4};

double either(Random& random) { return random.uniform() < 0.5 ? -1.0 : 1.0; }
double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

/// Which parameters a size scales, and how.
enum class Scaling { linear, inverse, departure };
struct Rule {
  std::string_view kind{};
  Scaling scaling = Scaling::linear;
  std::array<std::string_view, 3> scaled{};
  double largest = 30.0;
};

constexpr std::array<Rule, 38> kRules{{
    {"actuation_delay", Scaling::linear, {"delay"}, 12.0},
    {"torque_saturation", Scaling::inverse, {"limit"}, 8.0},
    {"torque_deadzone", Scaling::linear, {"threshold"}, 12.0},
    {"torque_gain", Scaling::departure, {"gain"}, 8.0},
    {"thermal_derating", Scaling::linear, {"loss"}, 12.0},
    {"amplifier_lag", Scaling::linear, {"time_constant"}, 12.0},
    {"torque_bias", Scaling::linear, {"bias"}, 30.0},
    {"torque_ripple", Scaling::linear, {"amplitude"}, 20.0},
    {"axis_coupling", Scaling::linear, {"fraction"}, 8.0},
    {"viscous_friction", Scaling::linear, {"coefficient"}, 30.0},
    {"coulomb_friction", Scaling::linear, {"level"}, 20.0},
    {"stribeck_friction", Scaling::linear, {"coulomb", "static"}, 20.0},
    {"presliding_hysteresis", Scaling::linear, {"level", "stiffness"}, 20.0},
    {"backlash", Scaling::linear, {"gap"}, 30.0},
    {"transmission_compliance", Scaling::inverse, {"stiffness"}, 3.0},
    {"cable_spring", Scaling::linear, {"stiffness"}, 20.0},
    {"payload", Scaling::linear, {"mass"}, 15.0},
    {"base_tilt", Scaling::linear, {"tilt_x", "tilt_z"}, 8.0},
    {"added_inertia", Scaling::linear, {"inertia"}, 20.0},
    {"encoder_scale", Scaling::departure, {"scale"}, 6.0},
    {"encoder_eccentricity", Scaling::linear, {"amplitude"}, 15.0},
    {"sensor_delay", Scaling::linear, {"delay"}, 12.0},
    {"time_base", Scaling::departure, {"ratio"}, 10.0},
    {"contact", Scaling::linear, {"stiffness", "damping"}, 40.0},
    {"hand_impedance", Scaling::linear, {"stiffness", "damping", "mass"}, 15.0},
    {"oov_growing_friction", Scaling::linear, {"level_at_end"}, 20.0},
    {"oov_local_friction", Scaling::linear, {"level"}, 20.0},
    {"oov_one_way_friction", Scaling::linear, {"level"}, 30.0},
    {"oov_catch", Scaling::linear, {"level"}, 40.0},
    {"oov_cross_coupling", Scaling::linear, {"amplitude"}, 20.0},
    {"oov_quadratic_drag", Scaling::linear, {"coefficient"}, 30.0},
    {"oov_hysteretic_spring", Scaling::linear, {"stiffness"}, 20.0},
    {"oov_command_rate_loss", Scaling::linear, {"share"}, 6.0},
    {"oov_varying_gain", Scaling::linear, {"amplitude"}, 8.0},
    {"oov_link_resonance", Scaling::inverse, {"stiffness"}, 20.0},
    {"oov_encoder_slips", Scaling::linear, {"counts"}, 60.0},
    {"oov_jitter_under_load", Scaling::linear, {"rms"}, 6.0},
    {"oov_logged_current", Scaling::linear, {"time_constant"}, 8.0},
}};

const Rule& rule_of(std::string_view kind) {
  return *std::find_if(kRules.begin(), kRules.end(),
                       [&](const Rule& rule) { return rule.kind == kind; });
}

using Parameters = std::vector<std::pair<std::string, double>>;

/// The diagonal of M in the middle of the workspace.
double inertia_of(const ArmModel& arm, std::size_t i) {
  const ArmModel::Lumped& body = arm.lumped();
  const double M11 = body.S0 + body.S2 * std::cos(0.8) - body.S3 * std::cos(0.5) +
                     body.K * std::cos(0.40) * std::sin(0.25);
  return i == 0 ? M11 : i == 1 ? body.M22 : body.M33;
}

double motor_ratio(const ArmModel& arm, std::size_t i) {
  return arm.parameters().transmission_ratio.at(i);
}

Parameters drawn_actuation(std::string_view kind, std::size_t i, const ArmModel& arm, Random& r) {
  if (kind == "actuation_delay") return {{"delay", 1e-3}};
  if (kind == "torque_saturation") return {{"limit", 0.2}};
  if (kind == "torque_deadzone") return {{"threshold", 1.5e-3}};
  if (kind == "torque_gain") return {{"gain", 1.0 + 0.05 * either(r)}};
  if (kind == "thermal_derating") {
    return {{"loss", 0.06}, {"time_constant", log_uniform(r, 0.8, 15.0)}};
  }
  if (kind == "amplifier_lag") return {{"time_constant", 1e-3}};
  if (kind == "torque_bias") return {{"bias", 2e-3 * either(r)}};
  if (kind == "torque_ripple") {
    const double cycles = std::floor(r.uniform(1.0, 8.0));
    return {{"amplitude", 2e-3},
            {"period", 2.0 * pi / (motor_ratio(arm, i) * cycles)},
            {"phase", r.uniform(0.0, 2.0 * pi)}};
  }
  if (kind == "axis_coupling") {
    const double from = static_cast<double>((i + (r.uniform() < 0.5 ? 1 : 2)) % kJoints + 1);
    return {{"fraction", 0.06 * either(r)}, {"from_axis", from}};
  }
  if (kind == "oov_varying_gain") {
    return {{"amplitude", 0.08},
            {"period_s", r.uniform(1.2, 6.0)},
            {"phase", r.uniform(0.0, 2.0 * pi)}};
  }
  if (kind == "oov_command_rate_loss") {
    return {{"share", 0.12}, {"rate_Nm_per_s", r.uniform(0.5, 3.0)}};
  }
  return {};
}

Parameters drawn_friction(std::string_view kind, std::size_t i, Random& r) {
  const double middle = kMiddle.at(i);
  if (kind == "viscous_friction") {
    return {{"coefficient", 3e-3}, {"asymmetry", r.uniform() < 0.6 ? 0.0 : r.uniform(-0.5, 0.5)}};
  }
  if (kind == "coulomb_friction") {
    return {{"level", 3e-3}, {"asymmetry", r.uniform() < 0.6 ? 0.0 : r.uniform(-0.4, 0.4)}};
  }
  if (kind == "stribeck_friction") {
    const double rise = r.uniform(1.2, 2.2);
    return {{"coulomb", 3e-3},
            {"static", 3e-3 * rise},
            {"stribeck_velocity", log_uniform(r, 0.01, 0.2)}};
  }
  if (kind == "presliding_hysteresis") {
    return {{"level", 4e-3}, {"stiffness", 4e-3 / log_uniform(r, 3e-4, 1.2e-2)}};
  }
  if (kind == "oov_quadratic_drag") return {{"coefficient", 4e-3}};
  if (kind == "oov_growing_friction") return {{"level_at_end", 6e-3}};
  if (kind == "oov_local_friction") {
    const double low = middle + r.uniform(-0.25, 0.1);
    return {{"level", 5e-3}, {"from_angle", low}, {"to_angle", low + r.uniform(0.08, 0.2)}};
  }
  if (kind == "oov_one_way_friction") {
    const double low = middle + r.uniform(-0.15, 0.1);
    return {
        {"level", 8e-3}, {"from_angle", low}, {"to_angle", low + 0.04}, {"direction", either(r)}};
  }
  if (kind == "oov_catch") return {{"level", 0.012}, {"share", 0.02}};
  return {};
}

Parameters drawn_joint(std::string_view kind, std::size_t i, const ArmModel& arm, Random& r) {
  const double M = inertia_of(arm, i);
  const double middle = kMiddle.at(i);
  if (kind == "backlash") return {{"gap", 6e-4}};
  if (kind == "transmission_compliance") {
    const double J = kRotor.at(i) * (M - kRotor.at(i)) / M;
    const double stiffness = 60.0 * M / 1e-3 * 0.5;
    return {{"stiffness", stiffness},
            {"damping", 2.0 * r.uniform(0.1, 0.4) * std::sqrt(stiffness * J)}};
  }
  if (kind == "cable_spring") {
    return {{"stiffness", 0.015}, {"rest_angle", middle + r.uniform(-0.5, 0.5)}};
  }
  if (kind == "added_inertia") return {{"inertia", 0.04 * M}};
  if (kind == "contact") {
    const double side = either(r);
    return {{"location", middle + side * r.uniform(0.08, 0.25)},
            {"stiffness", 0.5},
            {"damping", 0.5 * r.uniform(1e-3, 2e-2)},
            {"side", side}};
  }
  if (kind == "oov_hysteretic_spring") {
    return {{"stiffness", 0.03},
            {"rest_angle", middle + r.uniform(-0.15, 0.15)},
            {"loading_share", r.uniform(0.5, 0.9)},
            {"width", r.uniform(0.01, 0.04)}};
  }
  if (kind == "oov_link_resonance") {
    const double inertia = r.uniform(0.1, 0.25) * M;
    const double omega = 2.0 * pi * r.uniform(35.0, 60.0);
    const double stiffness = inertia * omega * omega;
    return {{"inertia", inertia},
            {"stiffness", stiffness},
            {"damping", 2.0 * r.uniform(0.02, 0.06) * std::sqrt(stiffness * inertia)}};
  }
  if (kind == "oov_cross_coupling") {
    return {{"amplitude", 3e-3},
            {"from_axis", static_cast<double>((i + (r.uniform() < 0.5 ? 1 : 2)) % kJoints + 1)},
            {"cycles_per_joint_rev", std::floor(r.uniform(5.0, 15.0))},
            {"phase", r.uniform(0.0, 2.0 * pi)}};
  }
  return {};
}

Parameters drawn_reading(std::string_view kind, std::size_t i, const ArmModel& arm, Random& r) {
  if (kind == "encoder_scale") return {{"scale", 1.0 + 0.03 * either(r)}};
  if (kind == "encoder_eccentricity") {
    const double cycles = r.uniform() < 0.35 ? 1.0 : motor_ratio(arm, i);
    return {{"amplitude", cycles == 1.0 ? 6e-3 : 4e-4},
            {"phase", r.uniform(0.0, 2.0 * pi)},
            {"cycles_per_joint_rev", cycles}};
  }
  if (kind == "sensor_delay") return {{"delay", 1e-3}};
  if (kind == "oov_encoder_slips") {
    return {{"counts", 4.0 * either(r)}, {"slips_per_run", std::floor(r.uniform(3.0, 9.0))}};
  }
  return {};
}

Parameters drawn_arm(std::string_view kind, Random& r) {
  if (kind == "payload") return {{"mass", 4e-3}};
  if (kind == "base_tilt") {
    const double direction = r.uniform(0.0, 2.0 * pi);
    return {{"tilt_x", 0.08 * std::cos(direction)}, {"tilt_z", 0.08 * std::sin(direction)}};
  }
  if (kind == "time_base") return {{"ratio", 1.0 + 0.015 * either(r)}};
  if (kind == "hand_impedance") {
    return {{"stiffness", r.uniform(1.0, 6.0)},
            {"damping", r.uniform(0.05, 0.25)},
            {"mass", r.uniform(0.002, 0.008)}};
  }
  if (kind == "oov_jitter_under_load") return {{"rms", 2e-4}, {"from_torque", 0.02}};
  if (kind == "oov_logged_current") return {{"time_constant", 1e-3}};
  return {};
}

}  // namespace

Sized::Sized(std::string_view kind,
             std::optional<std::size_t> axis,
             const ArmModel& arm,
             Random& random)
    : largest_{rule_of(find_kind(kind).name).largest} {
  one_.kind = kind;
  // Sizes shall not be multiples of the usual one.
  const double usual = log_uniform(random, 0.7, 1.4);
  if (!find_kind(kind).per_axis) {
    one_.parameters = drawn_arm(kind, random);
    one_ = at(usual);
    return;
  }
  const std::size_t i =
      axis ? *axis : std::min<std::size_t>(static_cast<std::size_t>(3.0 * random.uniform()), 2);
  one_.axis = i;
  for (const Parameters& drawn :
       {drawn_actuation(kind, i, arm, random), drawn_friction(kind, i, random),
        drawn_joint(kind, i, arm, random), drawn_reading(kind, i, arm, random)}) {
    if (!drawn.empty()) one_.parameters = drawn;
  }
  one_ = at(usual);
}

Effect Sized::at(double size) const {
  Effect effect = one_;
  const Rule& rule = rule_of(one_.kind);
  for (const std::string_view name : rule.scaled) {
    if (name.empty()) continue;
    double& value = effect.at(name);
    switch (rule.scaling) {
      case Scaling::linear:
        value *= size;
        break;
      case Scaling::inverse:
        value /= size;
        break;
      case Scaling::departure:
        value = 1.0 + (value - 1.0) * size;
        break;
    }
  }
  // The damping ratio stays.
  if (effect.kind == "transmission_compliance" || effect.kind == "oov_link_resonance") {
    effect.at("damping") /= std::sqrt(size);
  }
  if (effect.kind == "oov_encoder_slips") {
    double& counts = effect.at("counts");
    counts = std::copysign(std::max(1.0, std::round(std::abs(counts))), counts);
  }
  return effect;
}

}  // namespace teleop::concealed
