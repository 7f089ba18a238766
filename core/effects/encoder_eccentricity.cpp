#include <array>

#include "core/base/error.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "amplitude", .unit = "rad", .text = "of the reading", .range = kNotNegative},
    EffectParameter{
        .name = "phase", .unit = "rad", .text = "at angle zero", .range = kAny, .standard = 0.0},
    EffectParameter{.name = "cycles_per_joint_rev",
                    .unit = "1",
                    .text = "1: on the joint; the transmission ratio: on the motor",
                    .range = kPositive,
                    .standard = 1.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const AngleWave wave{.amplitude = values[0], .frequency = values[2], .phase = values[1]};
  if (!terms.sensing.at(axis).waves.push(wave)) {
    throw ConfigError{"encoder_eccentricity: at most four on one axis"};
  }
}

}  // namespace

const EffectKind encoder_eccentricity{
    .name = "encoder_eccentricity",
    .law = "y = m + amplitude sin(cycles_per_joint_rev m + phase)",
    .repeatable = true,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
