#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "delay",
                    .unit = "s",
                    .text = "from angle to reading",
                    .range = {.low = 0.0, .high = kMaxDelay_s}},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).delay += values[0];
}

}  // namespace

const EffectKind sensor_delay{
    .name = "sensor_delay",
    .law = "y(t) = m(t - delay)",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
