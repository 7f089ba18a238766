#include <numbers>

#include "core/model/dynamics.hpp"
#include "scenarios/regression/columns.hpp"

namespace teleop {
namespace {

using Place = Regressor::Place;
using Estimate = Regressor::Estimate;
using Use = Regressor::Use;
using Parameters = std::optional<std::vector<Regressor::Parameter>>;
using std::numbers::pi;

double command(const SmoothRun& run, const Place& place, std::size_t k) {
  return run.command[k][static_cast<Eigen::Index>(place.axis)];
}

/// What a change of the command by `law` adds to it.
template <class Law>
std::vector<Signal> change(const SmoothRun& run, const Place& place, Law&& law) {
  return {on_axis(run, place, [&](std::size_t k) {
    const double u = command(run, place, k);
    return law(u) - u;
  })};
}

std::vector<Signal> delayed(const SmoothRun& run, const Place& place) {
  const double late = place.shape / run.period_s;
  const auto whole = static_cast<std::size_t>(late);
  const double part = late - static_cast<double>(whole);
  return {on_axis(run, place, [&](std::size_t k) {
    const double newer = command(run, place, k - std::min(k, whole));
    const double older = command(run, place, k - std::min(k, whole + 1));
    return (1.0 - part) * newer + part * older - command(run, place, k);
  })};
}

std::vector<Signal> lagged(const SmoothRun& run, const Place& place) {
  const double memory = std::exp(-run.period_s / place.shape);
  double a = command(run, place, 0);
  return {on_axis(run, place, [&](std::size_t k) {
    const double u = command(run, place, k);
    a = memory * a + (1.0 - memory) * u;
    return a - u;
  })};
}

std::vector<Signal> heated(const SmoothRun& run, const Place& place) {
  constexpr double kReference_Nm = 0.03;
  double heat = 0.0;
  return {on_axis(run, place, [&](std::size_t k) {
    const double u = command(run, place, k);
    const double loss = -heat * u;
    heat += run.period_s / place.shape * (std::pow(u / kReference_Nm, 2.0) - heat);
    return loss;
  })};
}

std::vector<Signal> ripple(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  const auto angle = [&](std::size_t k) {
    return 2.0 * pi / place.shape * run.q[k][axis];
  };
  return {on_axis(run, place, [&](std::size_t k) { return std::sin(angle(k)); }),
          on_axis(run, place, [&](std::size_t k) { return std::cos(angle(k)); })};
}

/// By the motion, not by the command: a regression whose target stands among its columns explains
/// itself. gain · τ = M q̈ + … leaves a share 1 − 1/gain of the right-hand side.
std::vector<Signal> gain(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return {on_axis(run, place, [&](std::size_t k) {
    return inverse_dynamics(place.arm, run.q[k], run.qd[k], run.qdd[k])[axis];
  })};
}

/// The parameter that the shape is, where the column is the whole effect.
template <const char* const* name>
Parameters shape_alone(const Estimate& fit, const Place& /*place*/) {
  if (!is_whole(fit.coefficients[0])) return std::nullopt;
  return {{{*name, fit.shape, fit.shape_deviation}}};
}

constexpr const char* kDelay = "delay";
constexpr const char* kTimeConstant = "time_constant";
constexpr const char* kLimit = "limit";
constexpr const char* kThreshold = "threshold";

std::vector<Regressor> nonlinear_regressors() {
  return {
      {.kind = "actuation_delay",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(3e-4, 8e-3, 7); },
       .columns = delayed,
       .parameters = shape_alone<&kDelay>},
      {.kind = "amplifier_lag",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(4e-4, 1e-2, 6); },
       .columns = lagged,
       .parameters = shape_alone<&kTimeConstant>},
      {.kind = "torque_saturation",
       .continuous = true,
       .grid =
           [](const Use& use) {
             return geometric(0.3 * use.torque_peak, 0.95 * use.torque_peak, 6);
           },
       .columns =
           [](const SmoothRun& run, const Place& place) {
             return change(run, place,
                           [&](double u) { return std::clamp(u, -place.shape, place.shape); });
           },
       .parameters = shape_alone<&kLimit>},
      {.kind = "torque_deadzone",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(5e-4, 2e-2, 6); },
       .columns =
           [](const SmoothRun& run, const Place& place) {
             return change(run, place,
                           [&](double u) { return u - std::clamp(u, -place.shape, place.shape); });
           },
       .parameters = shape_alone<&kThreshold>},
      {.kind = "thermal_derating",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(0.5, 20.0, 6); },
       .columns = heated,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (fit.coefficients[0] <= 0.0 || fit.coefficients[0] > 0.5) return std::nullopt;
         return {{{"loss", fit.coefficients[0], fit.deviations[0]},
                  {"time_constant", fit.shape, fit.shape_deviation}}};
       }},
  };
}

}  // namespace

std::vector<Regressor> actuation_regressors() {
  std::vector<Regressor> list{
      {.kind = "torque_bias",
       .grid = no_grid,
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         return {on_axis(run, place, [](std::size_t /*k*/) { return 1.0; })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         return {{{"bias", fit.coefficients[0], fit.deviations[0]}}};
       }},
      {.kind = "torque_gain",
       .grid = no_grid,
       .columns = gain,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const double gain = 1.0 / (1.0 - fit.coefficients[0]);
         if (!is_near(gain, 1.0, 0.5)) return std::nullopt;
         return {{{"gain", gain, gain * gain * fit.deviations[0]}}};
       }},
      {.kind = "torque_ripple",
       .grid =
           [](const Use& use) {
             std::vector<double> periods;
             periods.reserve(8);
             for (int cycles = 1; cycles <= 8; ++cycles) {
               periods.push_back(2.0 * pi / (use.ratio * cycles));
             }
             return periods;
           },
       .columns = ripple,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const auto [amplitude, phase] = wave(fit);
         return {{amplitude, {"period", fit.shape, 0.0}, phase}};
       }},
      {.kind = "axis_coupling",
       .grid = [](const Use& /*use*/) { return std::vector<double>{1.0, 2.0, 3.0}; },
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         const auto from = static_cast<Eigen::Index>(place.shape) - 1;
         const bool other = from != static_cast<Eigen::Index>(place.axis);
         return {on_axis(run, place,
                         [&](std::size_t k) { return other ? run.command[k][from] : 0.0; })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (fit.coefficients[0] == 0.0 || !is_near(fit.coefficients[0], 0.0, 0.5)) {
           return std::nullopt;
         }
         return {
             {{"fraction", fit.coefficients[0], fit.deviations[0]}, {"from_axis", fit.shape, 0.0}}};
       }},
  };
  std::vector<Regressor> others = nonlinear_regressors();
  list.insert(list.end(), others.begin(), others.end());
  return list;
}

}  // namespace teleop
