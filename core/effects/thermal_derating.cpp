#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "loss",
                    .unit = "1",
                    .text = "share lost in the long run at 0.03 N m RMS",
                    .range = kNotNegative},
    EffectParameter{
        .name = "time_constant", .unit = "s", .text = "of the warming", .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).loss = values[0];
  terms.actuation.at(axis).thermal_time_constant = values[1];
}

}  // namespace

const EffectKind thermal_derating{
    .name = "thermal_derating",
    .law = "u becomes max(0.2, 1 - loss H) u; time_constant H' = (u / 0.03 N m)^2 - H",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
