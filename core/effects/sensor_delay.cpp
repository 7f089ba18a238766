#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "delay",
                    .unit = "s",
                    .text = "from angle to reading",
                    .range = {.low = 0.0, .high = kMaxDelay_s},
                    .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).delay += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  static_cast<void>(use);
  static_cast<void>(axis);
  return {{{4e-4}}, {{3e-3}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} is read {} late: a delay of the sensor.", of.axis(), of.size("delay"));
}

}  // namespace

const EffectKind sensor_delay{
    .name = "sensor_delay",
    .law = "y(t) = m(t - delay)",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
