#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "phase_error",
                    .unit = "count",
                    .text = "shift of channel B",
                    .range = {.low = -0.4, .high = 0.4}},
    EffectParameter{.name = "duty_error",
                    .unit = "count",
                    .text = "shift of the falling edges",
                    .range = {.low = -0.4, .high = 0.4},
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).phase_error = values[0];
  terms.sensing.at(axis).duty_error = values[1];
}

std::string words(const EffectValues& of) {
  return fmt::format("{} counts unevenly, by {} between its two channels: a misaligned encoder.",
                     of.axis(), of.magnitude("phase_error"));
}

}  // namespace

const EffectKind quadrature_error{
    .name = "quadrature_error",
    .law = "edges of channel B shifted by phase_error, falling edges by duty_error counts",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
