#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "delay",
                    .unit = "s",
                    .text = "from command to action",
                    .range = {.low = 0.0, .high = kMaxDelay_s}},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).delay += values[0];
}

}  // namespace

const EffectKind actuation_delay{
    .name = "actuation_delay",
    .law = "u(t) becomes u(t - delay)",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
