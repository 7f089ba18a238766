#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "steps_per_line",
                    .unit = "1",
                    .text = "16 to 64; quadrature has 4",
                    .range = {.low = 4.0, .high = 4096.0}},
    EffectParameter{.name = "error",
                    .unit = "line",
                    .text = "amplitude of the interpolation error",
                    .range = {.low = 0.0, .high = 0.1},
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).steps_per_line = values[0];
  terms.sensing.at(axis).interpolation_error = values[1];
}

std::string words(const EffectValues& of) {
  return fmt::format("{} divides each encoder line into {:.0f} steps: a sine encoder.", of.axis(),
                     of.value("steps_per_line"));
}

}  // namespace

const EffectKind sine_encoder{
    .name = "sine_encoder",
    .law = "steps_per_line steps a line; y = m + error sin(line phase)",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
