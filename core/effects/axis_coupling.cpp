#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "fraction",
                    .unit = "1",
                    .text = "of the other axis's command",
                    .range = kAny,
                    .neutral = 0.0},
    EffectParameter{.name = "from_axis",
                    .unit = "1 to 3",
                    .text = "the other axis",
                    .range = {.low = 1.0, .high = 3.0},
                    .role = EffectParameter::Role::given},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const auto from = static_cast<std::size_t>(std::lround(values[1])) - 1;
  terms.actuation.at(axis).coupling.at(from) += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  std::vector<EffectTrial> all;
  for (std::size_t from = 0; from < kJoints; ++from) {
    if (from != axis) all.push_back({{0.02, static_cast<double>(from + 1)}});
  }
  return all;
}

std::string words(const EffectValues& of) {
  return fmt::format("{} also receives {} of the commands of axis {:.0f}: the axes are coupled.",
                     of.axis(), of.size("fraction"), of.value("from_axis"));
}

}  // namespace

const EffectKind axis_coupling{
    .name = "axis_coupling",
    .law = "a becomes a + fraction u_from, u_from undistorted",
    .repeatable = true,
    .channel = Channel::actuation,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
