#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/paper_set.hpp"

namespace teleop {

/// The rows of the reproduction, in the order of its tables.
enum class PaperRowId {
  wall_linear,
  wall_stock,
  damping_100,
  damping_16,
  loop_gain_ratio,
  heat_linear,
  heat_pwm,
  velocity_granularity,
  velocity_lag,
};

inline constexpr std::array kPaperRows{
    PaperRowId::wall_linear, PaperRowId::wall_stock,           PaperRowId::damping_100,
    PaperRowId::damping_16,  PaperRowId::loop_gain_ratio,      PaperRowId::heat_linear,
    PaperRowId::heat_pwm,    PaperRowId::velocity_granularity, PaperRowId::velocity_lag};

struct PaperRowText {
  const char* id;
  double paper;
  const char* unit;
  const char* what;
};
[[nodiscard]] PaperRowText text_of(PaperRowId row);

/// What a row is with a set of parameters, by analysis: margins of the linear loop with Coulomb
/// friction as its describing function, the steady current of the drives, the two thermal nodes. In
/// the row's unit. Used to fit and for sensitivities; the tables come from experiments. Absent
/// where no analysis is needed because nothing of the set enters.
[[nodiscard]] std::optional<double> analysed(PaperRowId row, const PaperSet& set);

/// Whether analysed() has an answer.
[[nodiscard]] constexpr bool has_analysis(PaperRowId row) noexcept {
  return row != PaperRowId::velocity_granularity && row != PaperRowId::velocity_lag;
}

/// Casing over ambient after ten minutes of 2 N along −y at home, K.
[[nodiscard]] double casing_rise(const PaperSet& set, bool pwm);

/// Marginal stiffness of a virtual wall along y in which the tool is pressed: oscillations as large
/// as the penetration neither grow nor die, N/m.
[[nodiscard]] double pressed_wall(const PaperSet& set, double lag_s);

/// Parameters of the set moved within their bounds until the analysed rows come as near to the
/// paper as they can: least squares of log ratios [Levenberg–Marquardt]. What moved is marked
/// fitted.
[[nodiscard]] PaperSet fit_paper_set(const PaperSet& start);

}  // namespace teleop
