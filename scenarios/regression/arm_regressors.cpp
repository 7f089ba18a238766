#include <array>

#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "scenarios/regression/columns.hpp"

namespace teleop {
namespace {

using Place = Regressor::Place;
using Estimate = Regressor::Estimate;
using Use = Regressor::Use;
using Parameters = std::optional<std::vector<Regressor::Parameter>>;

constexpr double kStep = 1e-4;  // of derivatives by a size

/// What the tool is pulled with when `force` acts on it.
template <class Force>
Signal at_tool(const SmoothRun& run, const Place& place, Force&& force) {
  return torques(run, [&](std::size_t k) -> JointVector {
    return linear_jacobian(place.arm, run.q[k]).transpose() * force(k);
  });
}

Vector3 tool_velocity(const SmoothRun& run, const Place& place, std::size_t k) {
  return linear_jacobian(place.arm, run.q[k]) * run.qd[k];
}

Vector3 tool_acceleration(const SmoothRun& run, const Place& place, std::size_t k) {
  return linear_jacobian(place.arm, run.q[k]) * run.qdd[k] +
         linear_jacobian_rate(place.arm, run.q[k], run.qd[k]) * run.qd[k];
}

std::vector<Signal> payload(const SmoothRun& run, const Place& place) {
  const Vector3 up{0.0, place.arm.parameters().gravity_m_per_s2, 0.0};
  return {at_tool(run, place, [&](std::size_t k) -> Vector3 {
    return -tool_acceleration(run, place, k) - up;
  })};
}

std::vector<Signal> hand(const SmoothRun& run, const Place& place) {
  const Vector3 rest = tool_position(place.arm, {0.0, 0.40, 0.25});
  return {
      at_tool(run, place,
              [&](std::size_t k) -> Vector3 { return rest - tool_position(place.arm, run.q[k]); }),
      at_tool(run, place, [&](std::size_t k) -> Vector3 { return -tool_velocity(run, place, k); }),
      at_tool(run, place,
              [&](std::size_t k) -> Vector3 { return -tool_acceleration(run, place, k); })};
}

/// The weight's potential is up · (X, Y, Z) with up ≈ (−tilt_z, 1, tilt_x), X = R sin q1,
/// Z = R cos q1, R = N2 cos q2 + N3 sin q3.
std::vector<Signal> tilt(const SmoothRun& run, const Place& place) {
  const ArmModel::Lumped& body = place.arm.lumped();
  const auto slope = [&](const JointVector& q, double along, double across) -> JointVector {
    return {across * (body.N2 * std::cos(q[1]) + body.N3 * std::sin(q[2])),
            -along * body.N2 * std::sin(q[1]), along * body.N3 * std::cos(q[2])};
  };
  return {torques(run,
                  [&](std::size_t k) -> JointVector {
                    const JointVector& q = run.q[k];
                    return -slope(q, std::cos(q[0]), -std::sin(q[0]));
                  }),
          torques(run, [&](std::size_t k) {
            const JointVector& q = run.q[k];
            return slope(q, std::sin(q[0]), std::cos(q[0]));
          })};
}

/// By how much the inverse dynamics are too large for a unit of departure of the readings:
/// readings less kStep · departure are the motion.
struct Departure {
  double angle = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
};
template <class Law>
Signal misread(const SmoothRun& run, const Place& place, Law&& law) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return torques(run, [&](std::size_t k) -> JointVector {
    JointVector q = run.q[k];
    JointVector qd = run.qd[k];
    JointVector qdd = run.qdd[k];
    const JointVector read = inverse_dynamics(place.arm, q, qd, qdd);
    const Departure off = law(q[axis], qd[axis], qdd[axis]);
    q[axis] -= kStep * off.angle;
    qd[axis] -= kStep * off.speed;
    qdd[axis] -= kStep * off.acceleration;
    return (read - inverse_dynamics(place.arm, q, qd, qdd)) / kStep;
  });
}

std::vector<Signal> scale(const SmoothRun& run, const Place& place) {
  return {misread(run, place, [](double q, double v, double a) { return Departure{q, v, a}; })};
}

std::vector<Signal> eccentricity(const SmoothRun& run, const Place& place) {
  const double n = place.shape;
  return {misread(run, place,
                  [n](double q, double v, double a) {
                    const double s = std::sin(n * q);
                    const double c = std::cos(n * q);
                    return Departure{s, n * c * v, n * c * a - n * n * s * v * v};
                  }),
          misread(run, place, [n](double q, double v, double a) {
            const double s = std::sin(n * q);
            const double c = std::cos(n * q);
            return Departure{c, -n * s * v, -n * s * a - n * n * c * v * v};
          })};
}

std::vector<Signal> time_base(const SmoothRun& run, const Place& place) {
  constexpr double kRatio = 1.0 + kStep;
  return {torques(run, [&](std::size_t k) -> JointVector {
    const JointVector stated = inverse_dynamics(place.arm, run.q[k], run.qd[k], run.qdd[k]);
    const JointVector slower =
        inverse_dynamics(place.arm, run.q[k], run.qd[k] / kRatio, run.qdd[k] / (kRatio * kRatio));
    return (stated - slower) / kStep;
  })};
}

template <int side>
std::vector<Signal> wall(const SmoothRun& run, const Place& place) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  const auto depth = [&](std::size_t k) {
    return side * (run.q[k][axis] - place.shape);
  };
  return {
      on_axis(run, place, [&](std::size_t k) { return -side * std::max(0.0, depth(k)); }),
      on_axis(run, place, [&](std::size_t k) { return depth(k) > 0.0 ? -run.qd[k][axis] : 0.0; })};
}

/// Angles that few readings are beyond.
template <int side>
std::vector<double> wall_grid(const Use& use) {
  constexpr std::array kBeyond{0.02, 0.05, 0.1, 0.2, 0.35};
  std::vector<double> grid;
  grid.reserve(kBeyond.size());
  for (const double beyond : kBeyond) {
    const double share = side > 0 ? 1.0 - beyond : beyond;
    grid.push_back(
        use.angles[static_cast<std::size_t>(share * static_cast<double>(use.angles.size() - 1))]);
  }
  std::sort(grid.begin(), grid.end());
  return grid;
}

template <int side>
Parameters wall_parameters(const Estimate& fit, const Place& /*place*/) {
  if (fit.coefficients[0] <= 0.0) return std::nullopt;
  return {{{"location", fit.shape, fit.shape_deviation},
           {"stiffness", fit.coefficients[0], fit.deviations[0]},
           {"damping", std::max(0.0, fit.coefficients[1]), fit.deviations[1]},
           {"side", side, 0.0}}};
}

/// A list of names for coefficients that stand for themselves.
Parameters plain(const Estimate& fit,
                 std::initializer_list<std::string_view> names,
                 double nominal) {
  std::vector<Regressor::Parameter> list;
  list.reserve(names.size());
  for (const std::string_view name : names) {
    const std::size_t i = list.size();
    list.push_back({name, nominal + fit.coefficients[i], fit.deviations[i]});
  }
  return list;
}

std::vector<Regressor> load_regressors() {
  return {
      {.kind = "payload",
       .per_axis = false,
       .grid = no_grid,
       .columns = payload,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (fit.coefficients[0] <= 0.0) return std::nullopt;
         return plain(fit, {"mass"}, 0.0);
       }},
      {.kind = "base_tilt",
       .per_axis = false,
       .grid = no_grid,
       .columns = tilt,
       .parameters =
           [](const Estimate& fit, const Place& /*place*/) {
             return plain(fit, {"tilt_x", "tilt_z"}, 0.0);
           }},
      {.kind = "added_inertia",
       .grid = no_grid,
       .columns = [](const SmoothRun& run, const Place& place) -> std::vector<Signal> {
         const auto axis = static_cast<Eigen::Index>(place.axis);
         return {on_axis(run, place, [&](std::size_t k) { return -run.qdd[k][axis]; })};
       },
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (fit.coefficients[0] <= 0.0) return std::nullopt;
         return plain(fit, {"inertia"}, 0.0);
       }},
      {.kind = "hand_impedance",
       .per_axis = false,
       .grid = no_grid,
       .columns = hand,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         if (fit.coefficients[0] <= 0.0) return std::nullopt;
         return plain(fit, {"stiffness", "damping", "mass"}, 0.0);
       }},
  };
}

std::vector<Regressor> reading_regressors() {
  return {
      {.kind = "encoder_scale",
       .grid = no_grid,
       .columns = scale,
       .parameters =
           [](const Estimate& fit, const Place& /*place*/) {
             return plain(fit, {"scale"}, 1.0);
           }},
      {.kind = "encoder_eccentricity",
       .grid = [](const Use& use) { return std::vector<double>{1.0, use.ratio}; },
       .columns = eccentricity,
       .parameters = [](const Estimate& fit, const Place& /*place*/) -> Parameters {
         const auto [amplitude, phase] = wave(fit);
         if (!is_near(amplitude.value, 0.0, 0.1)) return std::nullopt;
         return {{amplitude, phase, {"cycles_per_joint_rev", fit.shape, 0.0}}};
       }},
      {.kind = "time_base",
       .per_axis = false,
       .grid = no_grid,
       .columns = time_base,
       .parameters =
           [](const Estimate& fit, const Place& /*place*/) {
             return plain(fit, {"ratio"}, 1.0);
           }},
  };
}

}  // namespace

std::vector<Regressor> arm_regressors() {
  std::vector<Regressor> list = load_regressors();
  const std::vector<Regressor> readings = reading_regressors();
  list.insert(list.end(), readings.begin(), readings.end());
  list.push_back({.kind = "contact",
                  .continuous = true,
                  .grid = wall_grid<1>,
                  .columns = wall<1>,
                  .parameters = wall_parameters<1>});
  list.push_back({.kind = "contact",
                  .continuous = true,
                  .grid = wall_grid<-1>,
                  .columns = wall<-1>,
                  .parameters = wall_parameters<-1>});
  return list;
}

}  // namespace teleop
