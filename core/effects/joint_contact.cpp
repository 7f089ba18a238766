#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "location", .unit = "rad", .text = "where the wall begins", .range = kAny},
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "of the wall",
                    .range = kPositive,
                    .neutral = 0.0},
    EffectParameter{.name = "damping",
                    .unit = "N m s/rad",
                    .text = "of the wall",
                    .range = kNotNegative,
                    .standard = 0.0,
                    .neutral = 0.0},
    EffectParameter{.name = "side",
                    .unit = "1",
                    .text = "+1: wall above the location, -1: below",
                    .range = {.low = -1.0, .high = 1.0},
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (std::abs(values[3]) != 1.0) throw ConfigError{"contact: side must be 1 or -1"};
  const JointWall wall{.axis = axis,
                       .location = values[0],
                       .stiffness = values[1],
                       .damping = values[2],
                       .side = values[3]};
  if (!terms.walls.push(wall)) throw ConfigError{"contact: at most six"};
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  constexpr int kPlaces = 8;
  constexpr double kStiffness = 0.2;  // N m/rad
  constexpr double kDamping = 1e-3;   // N m s/rad; a fit in its logarithm does not leave zero
  const AxisUse& own = use.at(axis);
  std::vector<EffectTrial> all;
  for (int i = 1; i < kPlaces; ++i) {
    const double place = own.low + (own.high - own.low) * static_cast<double>(i) / kPlaces;
    for (const double side : {1.0, -1.0}) {
      all.push_back({{place, kStiffness, kDamping, side}});
    }
  }
  return all;
}

std::string words(const EffectValues& of) {
  return fmt::format("{} meets something {} {}, as stiff as {}: contact.", of.axis(),
                     of.value("side") > 0.0 ? "above" : "below", of.size("location"),
                     of.size("stiffness"));
}

}  // namespace

const EffectKind joint_contact{
    .name = "contact",
    .law = "p = side (q - location) > 0: f = -side max(0, stiffness p + damping p')",
    .repeatable = true,
    .channel = Channel::environment,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
