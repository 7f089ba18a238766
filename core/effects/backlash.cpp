#include <array>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "gap",
                    .unit = "rad",
                    .text = "total width of the play",
                    .range = kPositive,
                    .neutral = 0.0},
    EffectParameter{.name = "drive_inertia",
                    .unit = "kg m^2",
                    .text = "moved from link to drive; 0: the rotor of the arm",
                    .range = kNotNegative,
                    .standard = 0.0,
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (terms.transmission.at(axis).kind != Transmission::Kind::rigid) {
    throw ConfigError{"backlash: the transmission of the axis gives way already"};
  }
  terms.transmission.at(axis) = {
      .kind = Transmission::Kind::play,
      .gap = values[0],
      .drive_inertia = values[1] > 0.0 ? values[1] : rotor_inertia(axis)};
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{2e-4, 0.0}}, {{1e-3, 0.0}}, {{4e-3, 0.0}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} has {} of play between motor and link: backlash.", of.axis(),
                     of.size("gap"));
}

}  // namespace

const EffectKind backlash{
    .name = "backlash",
    .law = "|m - q| <= gap / 2; T = 0 inside, at the ends as needed, pushing only",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
