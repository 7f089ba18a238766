#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "threshold",
                    .unit = "N m",
                    .text = "largest command that is lost",
                    .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.actuation.at(axis).threshold = values[0];
}

}  // namespace

const EffectKind torque_deadzone{
    .name = "torque_deadzone",
    .law = "u becomes 0 if |u| <= threshold, else u - threshold sgn(u)",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
