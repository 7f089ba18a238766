#include <array>
#include <numbers>

#include "core/base/error.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "amplitude", .unit = "N m", .text = "of the torque", .range = kPositive},
    EffectParameter{
        .name = "period", .unit = "rad", .text = "of the joint angle", .range = kPositive},
    EffectParameter{
        .name = "phase", .unit = "rad", .text = "at angle zero", .range = kAny, .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  const AngleWave wave{
      .amplitude = values[0], .frequency = 2.0 * std::numbers::pi / values[1], .phase = values[2]};
  if (!terms.actuation.at(axis).ripple.push(wave)) {
    throw ConfigError{"torque_ripple: at most four on one axis"};
  }
}

}  // namespace

const EffectKind torque_ripple{
    .name = "torque_ripple",
    .law = "a becomes a + amplitude sin(2 pi m / period + phase)",
    .repeatable = true,
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
