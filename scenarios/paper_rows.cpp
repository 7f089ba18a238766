#include "scenarios/paper_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "core/model/arm_model.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/held_motor.hpp"
#include "core/tuning/analytic_margin.hpp"

namespace teleop {
namespace {

/// Tool masses at home along x, y, z, kg: M is diagonal there and J_v is diag(l1, l1, l2).
JointVector tool_masses(const ArmModel& arm) {
  const double l1 = arm.parameters().l1_m;
  const double l2 = arm.parameters().l2_m;
  const auto M = mass_matrix(arm, JointVector::Zero());
  return {M(0, 0) / (l1 * l1), M(1, 1) / (l1 * l1), M(2, 2) / (l2 * l2)};
}

const ArmModel& phantom() {
  static const ArmModel arm = load_arm("phantom-1.5");
  return arm;
}

double margin_of(const SampledLoop& loop, TunedGain gain) {
  const auto margin = nyquist_margin(loop, gain);
  return margin ? margin->gain : 0.0;
}

double damping_limit(const PaperSet& set, double lag_s, int samples) {
  const double lightest = tool_masses(phantom()).minCoeff();
  const SampledLoop loop{
      .arms = {{.mass_kg = lightest, .damping_Ns_per_m = set[PaperSet::damping], .lag_s = lag_s}},
      .velocity = {.kind = "mean", .mean = {.samples = samples}}};
  return margin_of(loop, TunedGain::damping);
}

double loop_gain(const PaperSet& set, double lag_s) {
  double least = 1e300;
  for (const double mass : tool_masses(phantom())) {
    const LinearAxis::Config arm{
        .mass_kg = mass, .damping_Ns_per_m = set[PaperSet::damping], .lag_s = lag_s};
    least = std::min(least, margin_of({.arms = {arm, arm}}, TunedGain::stiffness));
  }
  return least;
}

/// Levenberg–Marquardt works on unbounded numbers: each parameter is a logistic curve between its
/// bounds.
double bounded(const PaperParameter& p, double x) {
  return p.low + (p.high - p.low) / (1.0 + std::exp(-x));
}
double unbounded(const PaperParameter& p) {
  const double share = std::clamp((p.value - p.low) / (p.high - p.low), 1e-6, 1.0 - 1e-6);
  return std::log(share / (1.0 - share));
}

constexpr std::array kFree{PaperSet::damping,
                           PaperSet::press,
                           PaperSet::lag_stock,
                           PaperSet::carrier,
                           PaperSet::winding_to_housing,
                           PaperSet::housing_to_ambient};
constexpr std::array kTargets{PaperRowId::wall_linear, PaperRowId::wall_stock,
                              PaperRowId::damping_100, PaperRowId::damping_16,
                              PaperRowId::heat_linear, PaperRowId::heat_pwm};

struct Misfit {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  // NOLINTBEGIN(readability-identifier-naming): Eigen asks for these names
  static constexpr int InputsAtCompileTime = Eigen::Dynamic;
  static constexpr int ValuesAtCompileTime = Eigen::Dynamic;
  // NOLINTEND(readability-identifier-naming)

  PaperSet start;

  [[nodiscard]] static int inputs() { return static_cast<int>(kFree.size()); }
  [[nodiscard]] static int values() { return static_cast<int>(kTargets.size()); }

  [[nodiscard]] PaperSet at(const Eigen::VectorXd& x) const {
    PaperSet set = start;
    for (std::size_t i = 0; i < kFree.size(); ++i) {
      PaperParameter& parameter = set.parameters.at(kFree[i]);
      parameter.value = bounded(parameter, x[static_cast<Eigen::Index>(i)]);
    }
    return set;
  }

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residual) const {
    const PaperSet set = at(x);
    for (std::size_t i = 0; i < kTargets.size(); ++i) {
      const double ours = analysed(kTargets[i], set).value_or(1.0);
      residual[static_cast<Eigen::Index>(i)] =
          std::log(std::max(ours, 1e-6) / text_of(kTargets[i]).paper);
    }
    return 0;
  }
};

}  // namespace

PaperRowText text_of(PaperRowId row) {
  switch (row) {
    case PaperRowId::wall_linear:
      return {"wall_linear", 2.7, "N/mm", "stiffest stable wall, linear amplifier"};
    case PaperRowId::wall_stock:
      return {"wall_stock", 2.0, "N/mm", "stiffest stable wall, stock drive"};
    case PaperRowId::damping_100:
      return {"damping_100", 5.0, "N s/m", "largest stable damping, mean of 100 samples"};
    case PaperRowId::damping_16:
      return {"damping_16", 11.0, "N s/m", "the same, period counter averaged over 16"};
    case PaperRowId::loop_gain_ratio:
      return {"loop_gain_ratio", 1.5, "1", "teleoperation gain, linear over stock"};
    case PaperRowId::heat_linear:
      return {"heat_linear", 14.5, "K", "casing after 10 min of 2 N, linear amplifier"};
    case PaperRowId::heat_pwm:
      return {"heat_pwm", 34.5, "K", "casing after 10 min of 2 N, stock PWM drive"};
    case PaperRowId::velocity_granularity:
      return {"velocity_granularity", 30.0, "mm/s", "smallest step of the first difference"};
    case PaperRowId::velocity_lag:
      return {"velocity_lag", 50.0, "ms", "lag of the mean of 100 samples"};
  }
  return {};
}

double pressed_wall(const PaperSet& set, double lag_s) {
  const double mass = tool_masses(phantom())[1];
  double stiffness = 2000.0;
  double friction = 0.0;
  constexpr double kSettled = 1e-7;
  for (int i = 0; i < 60; ++i) {
    const auto margin =
        nyquist_margin({.arms = {{.mass_kg = mass,
                                  .damping_Ns_per_m = set[PaperSet::damping] + friction,
                                  .lag_s = lag_s}}},
                       TunedGain::stiffness);
    if (!margin) return 0.0;
    const double amplitude = set[PaperSet::press] / stiffness;
    // Describing function of Coulomb friction in an oscillation of that amplitude [Gelb 1968].
    const double omega = 2.0 * std::numbers::pi * margin->frequency_Hz;
    friction = 4.0 * set[PaperSet::coulomb] / (std::numbers::pi * amplitude * omega);
    const double change = margin->gain / stiffness - 1.0;
    stiffness *= 1.0 + 0.85 * change;  // the friction answers weakly and the other way
    if (std::abs(change) < kSettled) break;
  }
  return stiffness;
}

double casing_rise(const PaperSet& set, bool pwm) {
  constexpr double kForce = 2.0;  // N, along −y: joint 2 alone at home
  constexpr double kSeconds = 600.0;
  const double arm_m = phantom().parameters().l1_m;
  const double ratio = phantom().parameters().transmission_ratio[1];
  HeldMotor motor{{.pwm = pwm,
                   .torque_Nm = kForce * arm_m,
                   .torque_per_ampere = set[PaperSet::torque_constant] * ratio,
                   .full_torque_Nm = set[PaperSet::full_force] * arm_m,
                   .resistance_ohm = set[PaperSet::resistance],
                   .inductance_H = set[PaperSet::inductance],
                   .carrier_Hz = set[PaperSet::carrier],
                   .winding_to_housing_K_per_W = set[PaperSet::winding_to_housing],
                   .housing_to_ambient_K_per_W = set[PaperSet::housing_to_ambient],
                   .winding_J_per_K = set[PaperSet::winding_capacity],
                   .housing_J_per_K = set[PaperSet::housing_capacity],
                   .copper_per_K = set[PaperSet::copper]}};
  motor.hold(kSeconds);
  return motor.casing_rise_K();
}

std::optional<double> analysed(PaperRowId row, const PaperSet& set) {
  const double linear = set[PaperSet::lag_linear];
  const double stock = set[PaperSet::lag_stock];
  switch (row) {
    case PaperRowId::wall_linear:
      return pressed_wall(set, linear) / 1e3;
    case PaperRowId::wall_stock:
      return pressed_wall(set, stock) / 1e3;
    case PaperRowId::damping_100:
      return damping_limit(set, stock, 100);
    case PaperRowId::damping_16:
      return damping_limit(set, linear, 16);
    case PaperRowId::loop_gain_ratio:
      return loop_gain(set, linear) / loop_gain(set, stock);
    case PaperRowId::heat_linear:
      return casing_rise(set, false);
    case PaperRowId::heat_pwm:
      return casing_rise(set, true);
    case PaperRowId::velocity_granularity:
    case PaperRowId::velocity_lag:
      break;
  }
  return std::nullopt;
}

PaperSet fit_paper_set(const PaperSet& start) {
  Eigen::NumericalDiff<Misfit, Eigen::Central> misfit{Misfit{start}, 1e-8};
  Eigen::VectorXd x(static_cast<Eigen::Index>(kFree.size()));
  for (std::size_t i = 0; i < kFree.size(); ++i) {
    x[static_cast<Eigen::Index>(i)] = unbounded(start.parameters.at(kFree[i]));
  }
  Eigen::LevenbergMarquardt solver{misfit};
  solver.parameters.maxfev = 400;
  solver.minimize(x);
  PaperSet fitted = misfit.at(x);
  for (const PaperSet::Index i : kFree) {
    PaperParameter& parameter = fitted.parameters.at(i);
    parameter.fitted_to.clear();
    for (const PaperRowId row : kTargets) {
      parameter.fitted_to.emplace_back(text_of(row).id);
    }
  }
  return fitted;
}

}  // namespace teleop
