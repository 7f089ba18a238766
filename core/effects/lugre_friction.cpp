#include <array>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "coulomb", .unit = "N m", .text = "level in fast motion", .range = kPositive},
    EffectParameter{
        .name = "static", .unit = "N m", .text = "level in slow motion", .range = kPositive},
    EffectParameter{.name = "stribeck_velocity",
                    .unit = "rad/s",
                    .text = "where the level has fallen by 63 % of the difference",
                    .range = kPositive},
    EffectParameter{
        .name = "stiffness", .unit = "N m/rad", .text = "of the bristles", .range = kPositive},
    EffectParameter{.name = "micro_damping",
                    .unit = "N m s/rad",
                    .text = "of the bristles",
                    .range = kNotNegative,
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (values[1] < values[0]) {
    throw ConfigError{"lugre_friction: static must be at least coulomb"};
  }
  terms.friction.at(axis).bristle = {.level = values[0],
                                     .static_level = values[1],
                                     .stribeck_velocity = values[2],
                                     .stiffness = values[3],
                                     .micro_damping = values[4]};
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} loses {} against fast motion, up to {} against slow, and bends before it slips: friction "
      "of bristles.",
      of.axis(), of.size("coulomb"), of.size("static"));
}

}  // namespace

const EffectKind lugre_friction{
    .name = "lugre_friction",
    .law = "f = -z - micro_damping z' / stiffness, z' = stiffness (m' - |m'| z / g(m'))",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
