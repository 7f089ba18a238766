#include <array>

#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{.name = "stiffness",
                    .unit = "N m/rad",
                    .text = "of the tendon, seen from the joint",
                    .range = kPositive},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.sensing.at(axis).tendon_stiffness = values[0];
}

}  // namespace

const EffectKind tendon_compliance{
    .name = "tendon_compliance",
    .law = "y = m + a / stiffness",
    .channel = Channel::sensing,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
