#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "tilt_x",
                    .unit = "rad",
                    .text = "about x",
                    .range = {.low = -3.15, .high = 3.15},
                    .standard = 0.0,
                    .neutral = 0.0},
    EffectParameter{.name = "tilt_z",
                    .unit = "rad",
                    .text = "about z",
                    .range = {.low = -3.15, .high = 3.15},
                    .standard = 0.0,
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  terms.load.tilt_x = values[0];
  terms.load.tilt_z = values[1];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{0.01, 0.0}, {0.0, 0.01}}};
}

std::vector<double> sized_here(const EffectTrial& trial, std::span<const double> shares) {
  return {trial[0][0] * shares[0], trial[1][1] * shares[1]};
}

std::string words(const EffectValues& of) {
  return fmt::format(
      "The base leans by {} about x and {} about z: weight acts in another direction.",
      of.size("tilt_x"), of.size("tilt_z"));
}

}  // namespace

const EffectKind base_tilt{
    .name = "base_tilt",
    .law = "up = Rx(tilt_x) Rz(tilt_z) e_y instead of e_y",
    .per_axis = false,
    .channel = Channel::load,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .sized = sized_here,
    .words = words,
};

}  // namespace teleop
