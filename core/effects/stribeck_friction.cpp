#include <array>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "coulomb",
                    .unit = "N m",
                    .text = "level in fast motion",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "static",
                    .unit = "N m",
                    .text = "level at rest",
                    .range = kNotNegative,
                    .neutral = 0.0},
    EffectParameter{.name = "stribeck_velocity",
                    .unit = "rad/s",
                    .text = "where the level has fallen by 63 % of the difference",
                    .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (values[1] < values[0]) {
    throw ConfigError{"stribeck_friction: static must be at least coulomb"};
  }
  JointFriction& friction = terms.friction.at(axis);
  friction.dry_forward += values[0];
  friction.dry_backward += values[0];
  friction.stribeck_rise = values[1] - values[0];
  friction.stribeck_velocity = values[2];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const AxisUse& own = use.at(axis);
  std::vector<EffectTrial> all;
  for (const double share : {0.03, 0.1, 0.3}) {
    all.push_back({{0.03 * own.torque, 0.05 * own.torque, share * own.speed}});
  }
  return all;
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} loses {} against fast motion and up to {} against slow: dry friction that falls with "
      "speed.",
      of.axis(), of.size("coulomb"), of.size("static"));
}

}  // namespace

const EffectKind stribeck_friction{
    .name = "stribeck_friction",
    .law =
        "f = -F(m') sgn(m'), F(v) = coulomb + (static - coulomb) exp(-(v / stribeck_velocity)^2)",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
