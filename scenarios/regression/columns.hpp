#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "scenarios/regression/regressor.hpp"

namespace teleop {

/// f(k) is the torque at sample k, N m on every axis.
template <class Law>
[[nodiscard]] Signal torques(const SmoothRun& run, Law&& law) {
  Signal signal;
  signal.reserve(run.q.size());
  for (std::size_t k = 0; k < run.q.size(); ++k) {
    signal.push_back(law(k));
  }
  return signal;
}

/// f(k) is the torque on the place's axis, the others have none.
template <class Law>
[[nodiscard]] Signal on_axis(const SmoothRun& run, const Regressor::Place& place, Law&& law) {
  const auto axis = static_cast<Eigen::Index>(place.axis);
  return torques(run, [&](std::size_t k) {
    JointVector torque = JointVector::Zero();
    torque[axis] = law(k);
    return torque;
  });
}

/// One axis of a signal.
[[nodiscard]] inline std::vector<double> axis_of(const Signal& signal, std::size_t axis) {
  std::vector<double> values;
  values.reserve(signal.size());
  for (const JointVector& each : signal) {
    values.push_back(each[static_cast<Eigen::Index>(axis)]);
  }
  return values;
}

[[nodiscard]] inline double sign(double x) noexcept { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/// n numbers from low to high in equal ratios.
[[nodiscard]] inline std::vector<double> geometric(double low, double high, std::size_t n) {
  std::vector<double> grid;
  grid.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    grid.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(n - 1)));
  }
  return grid;
}

[[nodiscard]] inline std::vector<double> no_grid(const Regressor::Use& /*use*/) { return {0.0}; }

/// Amplitude and phase of c₀ sin + c₁ cos.
[[nodiscard]] inline std::pair<Regressor::Parameter, Regressor::Parameter> wave(
    const Regressor::Estimate& fit) {
  const double amplitude = std::hypot(fit.coefficients[0], fit.coefficients[1]);
  const double deviation = (fit.deviations[0] + fit.deviations[1]) / 2.0;
  return {{"amplitude", amplitude, deviation},
          {"phase", std::atan2(fit.coefficients[1], fit.coefficients[0]),
           deviation / std::max(amplitude, 1e-12)}};
}

/// A column that is the whole effect, so that its coefficient should be 1.
[[nodiscard]] inline bool is_whole(double coefficient) noexcept {
  return coefficient > 0.5 && coefficient < 1.5;
}

/// No device that anybody would drive is off by more.
[[nodiscard]] inline bool is_near(double value, double nominal, double most) noexcept {
  return std::abs(value - nominal) <= most;
}

[[nodiscard]] std::vector<Regressor> actuation_regressors();
[[nodiscard]] std::vector<Regressor> joint_regressors();
[[nodiscard]] std::vector<Regressor> arm_regressors();

}  // namespace teleop
