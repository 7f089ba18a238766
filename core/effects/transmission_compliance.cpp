#include <array>

#include "core/base/error.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "stiffness", .unit = "N m/rad", .text = "of the transmission", .range = kPositive},
    EffectParameter{.name = "damping",
                    .unit = "N m s/rad",
                    .text = "of the transmission",
                    .range = kNotNegative},
    EffectParameter{.name = "drive_inertia",
                    .unit = "kg m^2",
                    .text = "moved from link to drive; 0: the rotor of the arm",
                    .range = kNotNegative,
                    .standard = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  if (terms.transmission.at(axis).kind != Transmission::Kind::rigid) {
    throw ConfigError{"transmission_compliance: the transmission of the axis gives way already"};
  }
  terms.transmission.at(axis) = {
      .kind = Transmission::Kind::compliant,
      .stiffness = values[0],
      .damping = values[1],
      .drive_inertia = values[2] > 0.0 ? values[2] : rotor_inertia(axis)};
}

}  // namespace

const EffectKind transmission_compliance{
    .name = "transmission_compliance",
    .law = "T = stiffness (m - q) + damping (m' - q')",
    .parameters = kParameters,
    .plug = plug,
};

}  // namespace teleop
