#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "level",
                    .unit = "N m",
                    .text = "in steady sliding",
                    .range = kPositive,
                    .neutral = 0.0},
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "at the turning points",
                    .range = kPositive,
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.friction.at(axis).bristle = {
      .level = values[0], .static_level = values[0], .stiffness = values[1]};
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  std::vector<EffectTrial> all;
  for (const double bend : {5e-4, 2e-3, 8e-3, 3e-2}) {
    const double level = 0.03 * use.at(axis).torque;
    all.push_back({{level, level / bend}});
  }
  return all;
}

std::string words(const EffectValues& of) {
  const double bend = of.value("level") / of.value("stiffness");
  return fmt::format(
      "{} loses {} against motion and bends by {} before it slips: presliding friction.", of.axis(),
      of.size("level"), quantity_text(bend, 0.0, "rad"));
}

}  // namespace

const EffectKind presliding_hysteresis{
    .name = "presliding_hysteresis",
    .law = "f = -z, dz/dm = stiffness (1 - (z / level) sgn(m'))",
    .channel = Channel::joint,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
