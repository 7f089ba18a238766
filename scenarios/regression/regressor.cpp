#include "scenarios/regression/regressor.hpp"

#include "core/model/dynamics.hpp"
#include "scenarios/regression/columns.hpp"

namespace teleop {
namespace {

using Place = Regressor::Place;

/// A torque on the place's axis that follows its angle, speed, command and the time.
template <double (*law)(double q, double v, double u, double t)>
std::vector<Signal> follows(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return {on_axis(run, place, [&](std::size_t k) {
    return law(run.q[k][axis], run.qd[k][axis], run.command[k][axis],
               run.period_s * static_cast<double>(k));
  })};
}

double drag(double /*q*/, double v, double /*u*/, double /*t*/) { return v * std::abs(v); }
double growing_friction(double /*q*/, double v, double /*u*/, double t) { return t * sign(v); }
double one_way(double /*q*/, double v, double /*u*/, double /*t*/) { return v > 0.0 ? 1.0 : 0.0; }
double local_friction(double q, double v, double /*u*/, double /*t*/) { return q * sign(v); }
double hardening(double q, double /*v*/, double /*u*/, double /*t*/) { return q * q; }
double varying_damping(double q, double v, double /*u*/, double /*t*/) { return q * v; }
double varying_gain(double q, double /*v*/, double u, double /*t*/) { return q * u; }
double curved_gain(double /*q*/, double /*v*/, double u, double /*t*/) { return u * std::abs(u); }
double drifting_gain(double /*q*/, double /*v*/, double u, double t) { return t * u; }
double drift(double /*q*/, double /*v*/, double /*u*/, double t) { return t; }
double loaded_friction(double /*q*/, double v, double u, double /*t*/) {
  return std::abs(u) * sign(v);
}

}  // namespace

std::span<const Regressor> regressors() {
  static const std::vector<Regressor> all = [] {
    std::vector<Regressor> list = actuation_regressors();
    for (const std::vector<Regressor>& others : {joint_regressors(), arm_regressors()}) {
      list.insert(list.end(), others.begin(), others.end());
    }
    return list;
  }();
  return all;
}

std::span<const Regressor> leftover_probes() {
  static const std::vector<Regressor> all{
      {.kind = "speed squared", .grid = no_grid, .columns = follows<drag>},
      {.kind = "direction × time", .grid = no_grid, .columns = follows<growing_friction>},
      {.kind = "forward motion", .grid = no_grid, .columns = follows<one_way>},
      {.kind = "direction × angle", .grid = no_grid, .columns = follows<local_friction>},
      {.kind = "angle squared", .grid = no_grid, .columns = follows<hardening>},
      {.kind = "angle × speed", .grid = no_grid, .columns = follows<varying_damping>},
      {.kind = "angle × command", .grid = no_grid, .columns = follows<varying_gain>},
      {.kind = "command squared", .grid = no_grid, .columns = follows<curved_gain>},
      {.kind = "command × time", .grid = no_grid, .columns = follows<drifting_gain>},
      {.kind = "time", .grid = no_grid, .columns = follows<drift>},
      {.kind = "direction × load", .grid = no_grid, .columns = follows<loaded_friction>},
  };
  return all;
}

Signal inverse_dynamics(const ArmModel& arm, const SmoothRun& run) {
  return torques(
      run, [&](std::size_t k) { return inverse_dynamics(arm, run.q[k], run.qd[k], run.qdd[k]); });
}

}  // namespace teleop
