#include "scenarios/concealed/law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.hpp"
#include "core/math/random.hpp"

namespace teleop::concealed {
namespace {

using std::numbers::pi;

constexpr std::array kRotor{1.8e-4, 1.25e-4, 1.25e-4};  // kg m²
constexpr double kRunLength = 8.0;                      // s
constexpr double kCatch = 0.04;                         // s, one of them

/// A mass at the tool: m JᵀJ has the form of the arm's own mass matrix.
void add_tool_mass(PlantLaw& law, double mass) {
  const double l1 = law.l1_m;
  const double l2 = law.l2_m;
  law.body.S0 += mass * (l1 * l1 + l2 * l2) / 2.0;
  law.body.S2 += mass * l1 * l1 / 2.0;
  law.body.S3 += mass * l2 * l2 / 2.0;
  law.body.K += 2.0 * mass * l1 * l2;
  law.body.M22 += mass * l1 * l1;
  law.body.M33 += mass * l2 * l2;
}

void split(AxisLaw& axis, std::size_t i) {
  axis.transmission.split = true;
  axis.transmission.rotor = kRotor.at(i);
}

bool add_arm_effect(PlantLaw& law, const Effect& effect, double gravity) {
  if (effect.kind == "payload") {
    add_tool_mass(law, effect.at("mass"));
    law.body.N2 += effect.at("mass") * gravity * law.l1_m;
    law.body.N3 += effect.at("mass") * gravity * law.l2_m;
  } else if (effect.kind == "base_tilt") {
    const double x = effect.at("tilt_x");
    const double z = effect.at("tilt_z");
    law.up = {-std::sin(z), std::cos(z) * std::cos(x), std::cos(z) * std::sin(x)};
  } else if (effect.kind == "hand_impedance") {
    law.hand_stiffness += effect.at("stiffness");
    law.hand_damping += effect.at("damping");
    add_tool_mass(law, effect.at("mass"));
  } else if (effect.kind == "time_base") {
    law.time_ratio *= effect.at("ratio");
  } else if (effect.kind == "oov_logged_current") {
    law.logs_current = true;
    law.current_lag = effect.at("time_constant");
  } else if (effect.kind == "oov_jitter_under_load") {
    for (AxisLaw& axis : law.axes) {
      axis.reading.jitter = effect.at("rms");
      axis.reading.jitter_from = effect.at("from_torque");
    }
  } else {
    return false;
  }
  return true;
}

bool add_actuation(ActuationLaw& law, const Effect& effect) {
  if (effect.kind == "actuation_delay") {
    law.delay += effect.at("delay");
  } else if (effect.kind == "torque_saturation") {
    law.limit = std::min(law.limit, effect.at("limit"));
  } else if (effect.kind == "torque_deadzone") {
    law.threshold += effect.at("threshold");
  } else if (effect.kind == "torque_gain") {
    law.gain *= effect.at("gain");
  } else if (effect.kind == "thermal_derating") {
    law.loss = effect.at("loss");
    law.heat_time = effect.at("time_constant");
  } else if (effect.kind == "amplifier_lag") {
    law.lag = effect.at("time_constant");
  } else if (effect.kind == "torque_bias") {
    law.bias += effect.at("bias");
  } else if (effect.kind == "torque_ripple") {
    law.ripple = {effect.at("amplitude"), 2.0 * pi / effect.at("period"), effect.at("phase")};
  } else if (effect.kind == "axis_coupling") {
    law.coupling.at(static_cast<std::size_t>(std::lround(effect.at("from_axis"))) - 1) +=
        effect.at("fraction");
  } else if (effect.kind == "oov_varying_gain") {
    law.gain_wave = {effect.at("amplitude"), 2.0 * pi / effect.at("period_s"), effect.at("phase")};
  } else if (effect.kind == "oov_command_rate_loss") {
    law.rate_share = effect.at("share");
    law.rate_scale = effect.at("rate_Nm_per_s");
  } else {
    return false;
  }
  return true;
}

bool add_friction(FrictionLaw& law, const Effect& effect, Random& random) {
  if (effect.kind == "viscous_friction") {
    law.viscous = effect.at("coefficient");
    law.viscous_asymmetry = effect.at("asymmetry");
  } else if (effect.kind == "coulomb_friction") {
    law.coulomb = effect.at("level");
    law.coulomb_asymmetry = effect.at("asymmetry");
  } else if (effect.kind == "stribeck_friction") {
    law.stribeck_coulomb = effect.at("coulomb");
    law.stribeck_static = effect.at("static");
    law.stribeck_velocity = effect.at("stribeck_velocity");
  } else if (effect.kind == "presliding_hysteresis") {
    law.dahl_level = effect.at("level");
    law.dahl_stiffness = effect.at("stiffness");
  } else if (effect.kind == "oov_quadratic_drag") {
    law.drag = effect.at("coefficient");
  } else if (effect.kind == "oov_growing_friction") {
    law.growth = effect.at("level_at_end") / kRunLength;
  } else if (effect.kind == "oov_local_friction" || effect.kind == "oov_one_way_friction") {
    law.patch_level = effect.at("level");
    law.patch_low = effect.at("from_angle");
    law.patch_high = effect.at("to_angle");
    law.patch_direction = effect.kind == "oov_local_friction" ? 0.0 : effect.at("direction");
  } else if (effect.kind == "oov_catch") {
    law.catch_level = effect.at("level");
    const auto number = std::lround(effect.at("share") * kRunLength / kCatch);
    for (long i = 0; i < number; ++i) {
      const double start = random.uniform(0.2, kRunLength - kCatch);
      law.catches.push_back({start, start + kCatch});
    }
  } else {
    return false;
  }
  return true;
}

bool add_joint(AxisLaw& axis, std::size_t i, const Effect& effect) {
  LinkLaw& link = axis.link;
  if (effect.kind == "backlash") {
    split(axis, i);
    axis.transmission.play = true;
    axis.transmission.gap = effect.at("gap");
  } else if (effect.kind == "transmission_compliance") {
    split(axis, i);
    axis.transmission.stiffness = effect.at("stiffness");
    axis.transmission.damping = effect.at("damping");
  } else if (effect.kind == "cable_spring") {
    link.spring = effect.at("stiffness");
    link.rest = effect.at("rest_angle");
  } else if (effect.kind == "added_inertia") {
    link.added_inertia += effect.at("inertia");
  } else if (effect.kind == "contact") {
    link.wall_location = effect.at("location");
    link.wall_stiffness = effect.at("stiffness");
    link.wall_damping = effect.at("damping");
    link.wall_side = effect.at("side");
  } else if (effect.kind == "oov_hysteretic_spring") {
    link.loading_spring = effect.at("stiffness");
    link.loading_rest = effect.at("rest_angle");
    link.loading = effect.at("loading_share");
    link.loading_width = effect.at("width");
  } else if (effect.kind == "oov_link_resonance") {
    link.absorber = effect.at("inertia");
    link.absorber_stiffness = effect.at("stiffness");
    link.absorber_damping = effect.at("damping");
  } else if (effect.kind == "oov_cross_coupling") {
    link.cross = {effect.at("amplitude"), effect.at("cycles_per_joint_rev"), effect.at("phase")};
    link.cross_from = static_cast<std::size_t>(std::lround(effect.at("from_axis"))) - 1;
  } else {
    return false;
  }
  return true;
}

bool add_reading(ReadingLaw& law, const Effect& effect, Random& random) {
  if (effect.kind == "encoder_scale") {
    law.scale *= effect.at("scale");
  } else if (effect.kind == "encoder_eccentricity") {
    law.eccentricity = {effect.at("amplitude"), effect.at("cycles_per_joint_rev"),
                        effect.at("phase")};
  } else if (effect.kind == "sensor_delay") {
    law.delay += effect.at("delay");
  } else if (effect.kind == "oov_encoder_slips") {
    law.slip_counts = effect.at("counts");
    const auto number = std::lround(effect.at("slips_per_run"));
    for (long i = 0; i < number; ++i) {
      law.slips.push_back(random.uniform(0.2, kRunLength));
    }
    std::sort(law.slips.begin(), law.slips.end());
  } else {
    return false;
  }
  return true;
}

}  // namespace

double Wave::at(double x) const noexcept {
  return amplitude == 0.0 ? 0.0 : amplitude * std::sin(frequency * x + phase);
}

bool FrictionLaw::dry() const noexcept {
  return coulomb > 0.0 || stribeck_static > 0.0 || stribeck_coulomb > 0.0 || growth > 0.0 ||
         patch_level > 0.0 || catch_level > 0.0;
}

FrictionLaw::Levels FrictionLaw::levels(double t, double m, double speed) const noexcept {
  double both = growth * t;
  if (stribeck_static > 0.0 || stribeck_coulomb > 0.0) {
    const double x = speed / stribeck_velocity;
    both += stribeck_coulomb + (stribeck_static - stribeck_coulomb) * std::exp(-x * x);
  }
  if (catch_level > 0.0 && std::any_of(catches.begin(), catches.end(), [&](const Window& window) {
        return window.start <= t && t < window.end;
      })) {
    both += catch_level;
  }
  const bool on_patch = patch_level > 0.0 && patch_low <= m && m <= patch_high;
  return {.forward = both + coulomb * (1.0 + coulomb_asymmetry) +
                     (on_patch && patch_direction >= 0.0 ? patch_level : 0.0),
          .backward = both + coulomb * (1.0 - coulomb_asymmetry) +
                      (on_patch && patch_direction <= 0.0 ? patch_level : 0.0)};
}

double FrictionLaw::smooth(double speed) const noexcept {
  const double sign = speed > 0.0 ? 1.0 : speed < 0.0 ? -1.0 : 0.0;
  return -viscous * (1.0 + viscous_asymmetry * sign) * speed - drag * std::abs(speed) * speed;
}

PlantLaw plant_law(const ArmModel& arm, std::span<const Effect> effects, std::uint64_t run_seed) {
  PlantLaw law{.body = arm.lumped(), .l1_m = arm.parameters().l1_m, .l2_m = arm.parameters().l2_m};
  Random random{run_seed};
  for (const Effect& effect : effects) {
    if (add_arm_effect(law, effect, arm.parameters().gravity_m_per_s2)) continue;
    const std::size_t i = effect.axis.value_or(kJoints);
    if (i >= kJoints) throw ConfigError{"effect " + effect.kind + " needs an axis, 1 to 3"};
    AxisLaw& axis = law.axes.at(i);
    if (!add_actuation(axis.actuation, effect) && !add_friction(axis.friction, effect, random) &&
        !add_joint(axis, i, effect) && !add_reading(axis.reading, effect, random)) {
      throw ConfigError{"no effect is called " + effect.kind + ": see the answer format"};
    }
  }
  return law;
}

}  // namespace teleop::concealed
