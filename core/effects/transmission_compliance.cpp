#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "of the transmission",
                    .range = kPositive,
                    .neutral = std::numeric_limits<double>::infinity()},
    EffectParameter{.name = "damping",
                    .unit = "N m s/rad",
                    .text = "of the transmission",
                    .range = kNotNegative},
    EffectParameter{.name = "drive_inertia",
                    .unit = "kg m^2",
                    .text = "moved from link to drive; 0: the rotor of the arm",
                    .range = kNotNegative,
                    .standard = 0.0,
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (terms.transmission.at(axis).kind != Transmission::Kind::rigid) {
    throw ConfigError{"transmission_compliance: the transmission of the axis gives way already"};
  }
  terms.transmission.at(axis) = {
      .kind = Transmission::Kind::compliant,
      .stiffness = values[0],
      .damping = values[1],
      .drive_inertia = values[2] > 0.0 ? values[2] : rotor_inertia(axis)};
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  const AxisUse& own = use.at(axis);
  const double moved =
      own.drive_inertia * (own.inertia - own.drive_inertia) / std::max(own.inertia, 1e-12);
  std::vector<EffectTrial> all;
  for (const double frequency_Hz : {25.0, 60.0, 150.0}) {
    const double rate = 2.0 * std::numbers::pi * frequency_Hz;
    constexpr double kDampingRatio = 0.1;
    all.push_back({{moved * rate * rate, 2.0 * kDampingRatio * moved * rate, 0.0}});
  }
  return all;
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "{} is driven through a spring of {} with damping {}: an elastic transmission.", of.axis(),
      of.size("stiffness"), of.size("damping"));
}

}  // namespace

const EffectKind transmission_compliance{
    .name = "transmission_compliance",
    .law = "T = stiffness (m - q) + damping (m' - q')",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
