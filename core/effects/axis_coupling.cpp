#include <array>
#include <cmath>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "fraction", .unit = "1", .text = "of the other axis's command", .range = kAny},
    EffectParameter{.name = "from_axis",
                    .unit = "1 to 3",
                    .text = "the other axis",
                    .range = {.low = 1.0, .high = 3.0}},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const auto from = static_cast<std::size_t>(std::lround(values[1])) - 1;
  terms.actuation.at(axis).coupling.at(from) += values[0];
}

}  // namespace

const EffectKind axis_coupling{
    .name = "axis_coupling",
    .law = "a becomes a + fraction u_from, u_from undistorted",
    .repeatable = true,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
