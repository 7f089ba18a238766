#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/effects/effect.hpp"

namespace teleop {

/// A number with its standard error and its unit as people write them: "11 ± 1 mNm", "7.0 ± 0.2 %".
/// The error has one digit, and the value ends where it does; without an error three digits.
/// @param unit as EffectParameter::unit has it
[[nodiscard]] std::string quantity_text(double value, double deviation, std::string_view unit);

/// "11.016 to 11.105 mNm": two digits of the width.
[[nodiscard]] std::string interval_text(double low, double high, std::string_view unit);

/// An effect with values, and how sure they are, as EffectKind::words speaks of it.
class EffectValues {
 public:
  /// @param deviations standard errors by parameter; what is missing is known exactly
  /// @pre check() accepts the effect. The effect must outlive this.
  EffectValues(const EffectSpec& effect, std::map<std::string, double> deviations);

  /// "Axis 2"
  [[nodiscard]] std::string axis() const;
  [[nodiscard]] double value(std::string_view parameter) const;
  /// "11 ± 1 mNm"
  [[nodiscard]] std::string size(std::string_view parameter) const;
  /// The size without its sign.
  [[nodiscard]] std::string magnitude(std::string_view parameter) const;
  /// Of a value that should be 1: "7.0 ± 0.2 % less".
  [[nodiscard]] std::string departure(std::string_view parameter,
                                      std::string_view more = "more",
                                      std::string_view less = "less") const;
  /// ", 12 ± 1 % more in positive motion", and nothing when the asymmetry is 0.
  [[nodiscard]] std::string asymmetry() const;

 private:
  [[nodiscard]] const EffectParameter& find(std::string_view parameter) const;
  [[nodiscard]] double deviation(std::string_view parameter) const;

  const EffectSpec& effect_;
  const EffectKind& kind_;
  std::map<std::string, double> deviations_;
};

/// The effect in a plain sentence: "Axis 2 loses 11 ± 1 mNm against every motion: dry friction."
/// @throws ConfigError as check() does.
[[nodiscard]] std::string sentence_of(const EffectSpec& effect,
                                      const std::map<std::string, double>& deviations = {});

}  // namespace teleop
