#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "noise", .unit = "m/s^2", .text = "RMS of a reading", .range = kNotNegative},
    EffectParameter{.name = "bandwidth_Hz",
                    .unit = "Hz",
                    .text = "of the sensor",
                    .range = kPositive,
                    .standard = 500.0},
    EffectParameter{.name = "range",
                    .unit = "m/s^2",
                    .text = "largest reading",
                    .range = kPositive,
                    .standard = 160.0},
};

void plug(PlantTerms& terms, std::size_t /*axis*/, std::span<const double> values) {
  terms.accelerometer = {
      .fitted = true, .noise = values[0], .bandwidth_Hz = values[1], .range = values[2]};
}

std::string words(const EffectValues& of) {
  return fmt::format("The tool carries an accelerometer with a noise of {}.", of.size("noise"));
}

}  // namespace

const EffectKind tool_accelerometer{
    .name = "tool_accelerometer",
    .law =
        "reads the tool's acceleration behind a first-order filter, with noise, within its range",
    .per_axis = false,
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
    .words = words,
};

}  // namespace teleop
