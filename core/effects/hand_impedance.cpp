#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "stiffness",
                    .unit = "N/m",
                    .text = "of the grip",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "damping",
                    .unit = "N s/m",
                    .text = "of the grip",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "mass",
                    .unit = "kg",
                    .text = "that moves with the tool",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "posture_1",
                    .unit = "rad",
                    .text = "q1 of the posture whose tool position is p_0",
                    .range = kAny,
                    .standard = 0.0,
                    .role = EffectParameter::Role::given},
    EffectParameter{.name = "posture_2",
                    .unit = "rad",
                    .text = "q2 of it",
                    .range = kAny,
                    .standard = 0.40,
                    .role = EffectParameter::Role::given},
    EffectParameter{.name = "posture_3",
                    .unit = "rad",
                    .text = "q3 of it",
                    .range = kAny,
                    .standard = 0.25,
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  LoadTerms& load = terms.load;
  load.grip_stiffness = values[0];
  load.grip_damping = values[1];
  load.grip_mass = values[2];
  load.grip_posture = {values[3], values[4], values[5]};
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  const std::vector<double> posture{0.0, 0.40, 0.25};
  EffectTrial trial{{2.0, 0.0, 0.0}, {0.0, 0.1, 0.0}, {0.0, 0.0, 2e-3}};
  for (std::vector<double>& step : trial) {
    step.insert(step.end(), posture.begin(), posture.end());
  }
  return {trial};
}

std::vector<double> sized_here(const EffectTrial& trial, std::span<const double> shares) {
  std::vector<double> values = trial[0];
  for (std::size_t i = 0; i < 3; ++i) {
    values[i] = shares[i] * trial[i][i];
  }
  return values;
}

std::string words(const EffectValues& of) {
  return fmt::format("Something holds the tool with {}, {} and {}: a hand.", of.size("stiffness"),
                     of.size("damping"), of.size("mass"));
}

}  // namespace

const EffectKind hand_impedance{
    .name = "hand_impedance",
    .law = "F = -stiffness (p - p_0) - damping p'; mass moves with the tool and has no weight here",
    .per_axis = false,
    .channel = Channel::environment,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .sized = sized_here,
    .words = words,
};

}  // namespace teleop
