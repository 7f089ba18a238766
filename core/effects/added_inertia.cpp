#include <array>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_words.hpp"
#include "core/effects/kinds.hpp"

namespace teleop {
namespace {

constexpr std::array kParameters{
    EffectParameter{
        .name = "inertia", .unit = "kg m^2", .text = "of the link", .range = kAny, .neutral = 0.0},
};

void plug(PlantTerms& terms, std::size_t axis, std::span<const double> values) {
  terms.load.added_inertia.at(axis) += values[0];
}

std::vector<EffectTrial> trials(const MachineUse& use, std::size_t axis) {
  return {{{0.01 * use.at(axis).inertia}}};
}

std::string words(const EffectValues& of) {
  return fmt::format("{} has {} {} inertia than the model.", of.axis(), of.magnitude("inertia"),
                     of.value("inertia") < 0.0 ? "less" : "more");
}

}  // namespace

const EffectKind added_inertia{
    .name = "added_inertia",
    .law = "M_ii becomes M_ii + inertia",
    .channel = Channel::load,
    .parameters = kParameters,
    .plug = plug,
    .trials = trials,
    .words = words,
};

}  // namespace teleop
