#include "scenarios/scoring/equivalence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

constexpr double kShort_s = 8e-4;           // a lag far above what is excited is a delay
constexpr double kPresliding_rad = 2e-4;    // a few counts
constexpr double kDip = 1.1;                // static over Coulomb
constexpr double kDipSpeed = 3e-3;          // rad/s
constexpr double kSmallDeparture = 0.03;    // of axis 1
constexpr double kInertia1_kg_m2 = 3.5e-3;  // about that of axis 1
constexpr double kNearCrossing = 0.15;      // tangent of the phase
constexpr std::array kMiddle_rad{0.0, 0.40, 0.25};

using Names = std::vector<EffectName>;

double at(const TrueEffect& effect, const char* name) {
  const auto found = effect.parameters.find(name);
  expects(found != effect.parameters.end(), "a true effect has all its parameters");
  return found->second;
}

bool is_delay(const EffectName& name) {
  return name.kind == "actuation_delay" || name.kind == "sensor_delay";
}

void add_timing(const TrueEffect& effect, Names& names) {
  const auto axis = effect.name.axis;
  const bool lag = effect.name.kind == "amplifier_lag";
  if (is_delay(effect.name) || (lag && at(effect, "time_constant") < kShort_s)) {
    names.insert(names.end(), {{"actuation_delay", axis}, {"sensor_delay", axis}});
  }
  if (is_delay(effect.name) && at(effect, "delay") < kShort_s) {
    names.push_back({"amplifier_lag", axis});
  }
}

/// How much less a unit of torque moves axis 1 in the readings.
double loss_of(const TrueEffect& effect) {
  if (effect.name.kind == "torque_gain") return 1.0 - at(effect, "gain");
  if (effect.name.kind == "encoder_scale") return 1.0 - at(effect, "scale");
  if (effect.name.kind == "added_inertia") return at(effect, "inertia") / kInertia1_kg_m2;
  return 0.0;
}

void add_scaling(const TrueEffect& effect, Names& names) {
  const auto& [kind, axis] = effect.name;
  if ((axis == 1 || axis == 3) && (kind == "torque_gain" || kind == "encoder_scale")) {
    names.insert(names.end(), {{"torque_gain", axis}, {"encoder_scale", axis}});
  }
  if (axis != 1) return;
  const double loss = loss_of(effect);
  if (loss > 0.0 && loss < kSmallDeparture) {
    names.insert(names.end(), {{"torque_gain", 1}, {"encoder_scale", 1}, {"added_inertia", 1}});
  }
}

void add_simpler(const TrueEffect& effect, Names& names) {
  const auto& [kind, axis] = effect.name;
  if (kind == "presliding_hysteresis" &&
      at(effect, "level") / at(effect, "stiffness") < kPresliding_rad) {
    names.push_back({"coulomb_friction", axis});
  }
  if (kind == "stribeck_friction" && (at(effect, "static") / at(effect, "coulomb") < kDip ||
                                      at(effect, "stribeck_velocity") < kDipSpeed)) {
    names.push_back({"coulomb_friction", axis});
  }
  if (kind == "base_tilt" &&
      std::abs(at(effect, "tilt_x")) < 0.1 * std::abs(at(effect, "tilt_z"))) {
    names.push_back({"torque_bias", 1});
  }
  if (kind == "encoder_eccentricity" && axis && at(effect, "cycles_per_joint_rev") == 1.0) {
    const double middle = kMiddle_rad.at(static_cast<std::size_t>(*axis - 1));
    if (std::abs(std::tan(at(effect, "phase") + middle)) < kNearCrossing) {
      names.push_back({"encoder_scale", axis});
      if (axis == 1) names.push_back({"torque_gain", axis});
    }
  }
}

}  // namespace

std::vector<EffectName> equivalents(const TrueEffect& effect) {
  Names names;
  if (!effect.in_vocabulary) return names;
  add_timing(effect, names);
  add_scaling(effect, names);
  add_simpler(effect, names);
  std::erase(names, effect.name);
  return names;
}

}  // namespace teleop
