#include "core/effects/effect_words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/contract.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

/// How a unit is written, and in which multiples: `scale` of them make one of ours.
struct WrittenUnit {
  std::string_view unit{};
  std::string_view text{};
  double scale = 1.0;
  bool prefixed = false;  ///< m and µ where that is handier
};

constexpr std::array kUnits{
    WrittenUnit{"N m", "Nm", 1.0, true},
    WrittenUnit{"N m/rad", "Nm/rad", 1.0, true},
    WrittenUnit{"N m s/rad", "Nms/rad", 1.0, true},
    WrittenUnit{"rad", "rad", 1.0, true},
    WrittenUnit{"s", "s", 1.0, true},
    WrittenUnit{"kg", "g", 1e3, true},
    WrittenUnit{"kg m^2", "kg mm²", 1e6, false},
    WrittenUnit{"1", "%", 1e2, false},
    WrittenUnit{"H", "H", 1.0, true},
    WrittenUnit{"ohm", "Ω", 1.0, false},
    WrittenUnit{"N s/m", "Ns/m", 1.0, false},
    WrittenUnit{"m/s^2", "m/s²", 1.0, false},
    WrittenUnit{"degC", "°C", 1.0, false},
};

WrittenUnit written(std::string_view unit) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                  [&](const WrittenUnit& each) { return each.unit == unit; });
  return found != kUnits.end() ? *found : WrittenUnit{.unit = unit, .text = unit};
}

int decimals_of(double size, int digits) {
  if (!(size > 0.0) || !std::isfinite(size)) return 0;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(size))), 0, 9);
}

}  // namespace

std::string quantity_text(double value, double deviation, std::string_view unit) {
  const WrittenUnit how = written(unit);
  double factor = how.scale;
  std::string_view prefix;
  const double size = std::abs(value) * factor;
  if (how.prefixed && size > 0.0) {
    if (size < 0.9995e-3) {
      factor *= 1e6;
      prefix = "µ";
    } else if (size < 0.9995) {
      factor *= 1e3;
      prefix = "m";
    }
  }
  const double shown = value * factor;
  const char* sign = shown < 0.0 ? "−" : "";
  if (!(deviation > 0.0)) {
    return fmt::format("{}{:.{}f} {}{}", sign, std::abs(shown), decimals_of(std::abs(shown), 3),
                       prefix, how.text);
  }
  const int decimals = decimals_of(deviation * factor, 1);
  return fmt::format("{}{:.{}f} ± {:.{}f} {}{}", sign, std::abs(shown), decimals,
                     deviation * factor, decimals, prefix, how.text);
}

EffectValues::EffectValues(const EffectSpec& effect, std::map<std::string, double> deviations)
    : effect_{effect}, kind_{find_effect(effect.kind)}, deviations_{std::move(deviations)} {}

std::string EffectValues::axis() const {
  return fmt::format("Axis {}", effect_.axis.value_or(0) + 1);
}

const EffectParameter& EffectValues::find(std::string_view parameter) const {
  const auto found =
      std::find_if(kind_.parameters.begin(), kind_.parameters.end(),
                   [&](const EffectParameter& each) { return each.name == parameter; });
  expects(found != kind_.parameters.end(), "an effect speaks of its own parameters");
  return *found;
}

double EffectValues::value(std::string_view parameter) const {
  const auto found = effect_.parameters.find(std::string{parameter});
  return found != effect_.parameters.end() ? found->second : find(parameter).standard.value_or(0.0);
}

double EffectValues::deviation(std::string_view parameter) const {
  const auto found = deviations_.find(std::string{parameter});
  return found != deviations_.end() ? found->second : 0.0;
}

std::string EffectValues::size(std::string_view parameter) const {
  return quantity_text(value(parameter), deviation(parameter), find(parameter).unit);
}

std::string EffectValues::magnitude(std::string_view parameter) const {
  return quantity_text(std::abs(value(parameter)), deviation(parameter), find(parameter).unit);
}

std::string EffectValues::departure(std::string_view parameter,
                                    std::string_view more,
                                    std::string_view less) const {
  const double by = value(parameter) - 1.0;
  return fmt::format("{} {}", quantity_text(std::abs(by), deviation(parameter), "1"),
                     by < 0.0 ? less : more);
}

std::string EffectValues::asymmetry() const {
  const double share = value("asymmetry");
  if (share == 0.0) return {};
  return fmt::format(", {} more than the mean in {} motion", magnitude("asymmetry"),
                     share > 0.0 ? "positive" : "negative");
}

std::string sentence_of(const EffectSpec& effect, const std::map<std::string, double>& deviations) {
  check(effect);
  return find_effect(effect.kind).words(EffectValues{effect, deviations});
}

}  // namespace teleop
