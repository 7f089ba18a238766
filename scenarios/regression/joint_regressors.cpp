#include "core/effects/kinds.hpp"
#include "core/model/dynamics.hpp"
#include "scenarios/regression/columns.hpp"

namespace teleop {
namespace {

using Place = Regressor::Place;
using Estimate = Regressor::Estimate;
using Use = Regressor::Use;
using Parameters = std::optional<std::vector<Regressor::Parameter>>;

/// A torque that depends on angle and speed of the axis at the same instant.
template <class Law>
Signal torque_of(const SmoothRun& run, const Place& place, Law&& law) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return on_axis(run, place, [&](std::size_t k) { return law(run.q[k][axis], run.qd[k][axis]); });
}

std::vector<Signal> stribeck(const SmoothRun& run, const Place& place) {
  return {torque_of(run, place, [](double /*q*/, double v) { return -sign(v); }),
          torque_of(run, place, [&](double /*q*/, double v) {
            return -sign(v) * std::exp(-std::pow(v / place.shape, 2.0));
          })};
}

/// Dahl's state over its level; the shape is level / stiffness.
std::vector<Signal> presliding(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  double z = 0.0;
  double before = run.q.front()[axis];
  return {on_axis(run, place, [&](std::size_t k) {
    const double moved = run.q[k][axis] - before;
    before = run.q[k][axis];
    // Exact along a movement in one direction.
    z = sign(moved) + (z - sign(moved)) * std::exp(-std::abs(moved) / place.shape);
    return -z;
  })};
}

/// Of the link alone: what the drive's inertia leaves.
double link_inertia(const Place& place, const JointVector& q) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return mass_matrix(place.arm, q)(axis, axis) - rotor_inertia(place.axis);
}

/// The link stays behind the drive by the play: less acceleration than the readings show.
std::vector<Signal> play(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  std::vector<double> behind;
  behind.reserve(run.q.size());
  double link = run.q.front()[axis];
  for (const JointVector& q : run.q) {
    link = std::clamp(link, q[axis] - place.shape / 2.0, q[axis] + place.shape / 2.0);
    behind.push_back(q[axis] - link);
  }
  return {on_axis(run, place, [&](std::size_t k) {
    if (k == 0 || k + 1 >= behind.size()) return 0.0;
    const double acceleration =
        (behind[k + 1] - 2.0 * behind[k] + behind[k - 1]) / (run.period_s * run.period_s);
    return link_inertia(place, run.q[k]) * acceleration;
  })};
}

/// The link stays behind the drive by T/k, with T what the drive does not need for itself.
std::vector<Signal> wind_up(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  const ZeroPhaseFilter filter{60.0, run.period_s};
  Signal transmitted = torques(run, [&](std::size_t k) {
    return JointVector{run.command[k] - rotor_inertia(place.axis) * run.qdd[k]};
  });
  transmitted = filter(std::move(transmitted));
  return {on_axis(run, place, [&](std::size_t k) {
    if (k == 0 || k + 1 >= transmitted.size()) return 0.0;
    const double bend =
        transmitted[k + 1][axis] - 2.0 * transmitted[k][axis] + transmitted[k - 1][axis];
    return link_inertia(place, run.q[k]) * bend / (run.period_s * run.period_s);
  })};
}

Parameters positive(std::string_view name, const Estimate& fit) {
  if (fit.coefficients[0] <= 0.0) return std::nullopt;
  return {{{name, fit.coefficients[0], fit.deviations[0]}}};
}

std::vector<Regressor> friction_regressors() {
  return {
      {.kind = "viscous_friction",
       .grid = no_grid,
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         return {torque_of(run, place, [](double /*q*/, double v) { return -v; })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         return positive("coefficient", fit);
       }},
      {.kind = "coulomb_friction",
       .grid = no_grid,
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         return {torque_of(run, place, [](double /*q*/, double v) { return -sign(v); })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         return positive("level", fit);
       }},
      {.kind = "stribeck_friction",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(0.01, 0.5, 5); },
       .columns = stribeck,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const auto& c = fit.coefficients;
         if (c[0] <= 0.0 || c[1] <= 0.0) return std::nullopt;
         return {{{"coulomb", c[0], fit.deviations[0]},
                  {"static", c[0] + c[1], std::hypot(fit.deviations[0], fit.deviations[1])},
                  {"stribeck_velocity", fit.shape, fit.shape_deviation}}};
       }},
      {.kind = "presliding_hysteresis",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(3e-4, 3e-2, 6); },
       .columns = presliding,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const double level = fit.coefficients[0];
         if (level <= 0.0) return std::nullopt;
         const double share = fit.deviations[0] / level;
         return {{{"level", level, fit.deviations[0]},
                  {"stiffness", level / fit.shape,
                   level / fit.shape * std::hypot(share, fit.shape_deviation / fit.shape)}}};
       }},
  };
}

}  // namespace

std::vector<Regressor> joint_regressors() {
  std::vector<Regressor> list = friction_regressors();
  const std::vector<Regressor> others{
      {.kind = "backlash",
       .continuous = true,
       .grid = [](const Use& /*use*/) { return geometric(1e-4, 1e-2, 6); },
       .columns = play,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (!is_whole(fit.coefficients[0])) return std::nullopt;
         return {{{"gap", fit.shape, fit.shape_deviation}}};
       }},
      {.kind = "transmission_compliance",
       .grid = no_grid,
       .columns = wind_up,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const double yielding = fit.coefficients[0];
         if (yielding <= 0.0) return std::nullopt;
         return {{{"stiffness", 1.0 / yielding, fit.deviations[0] / (yielding * yielding)},
                  {"damping", 0.0, 0.0}}};
       }},
      {.kind = "cable_spring",
       .grid = no_grid,
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         return {torque_of(run, place, [](double q, double /*v*/) { return -q; }),
                 torque_of(run, place, [](double /*q*/, double /*v*/) { return 1.0; })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const auto& c = fit.coefficients;
         if (c[0] <= 0.0) return std::nullopt;
         return {{{"stiffness", c[0], fit.deviations[0]},
                  {"rest_angle", c[1] / c[0], fit.deviations[1] / c[0]}}};
       }},
  };
  list.insert(list.end(), others.begin(), others.end());
  return list;
}

}  // namespace teleop
