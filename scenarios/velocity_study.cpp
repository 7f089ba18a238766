#include "scenarios/velocity_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/estimation/velocity_response.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr double kLeastAmplitude_m = 0.3e-3;
constexpr double kAmplitude_counts = 10.0;

/// @returns the settings as text, after `assignments` have been made in `config`.
std::string configure(VelocityEstimator::Config& config,
                      const std::vector<std::string>& assignments) {
  Settings settings;
  add_settings(settings, "velocity.", config);
  for (const std::string& assignment : assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) {
      throw ConfigError{fmt::format("--set {}: must be KEY=VALUE", assignment)};
    }
    settings.set(assignment.substr(0, equals), assignment.substr(equals + 1), "--set");
  }
  return settings.print();
}

std::string name_of(const VelocityEstimator::Config& config) {
  if (config.kind == "difference") {
    if (config.difference.cutoff_Hz <= 0.0) return "first difference";
    return fmt::format("difference, {:g} Hz", config.difference.cutoff_Hz);
  }
  if (config.kind == "mean") return fmt::format("mean of {}", config.mean.samples);
  if (config.kind == "period") return fmt::format("period, mean of {}", config.period.samples);
  if (config.kind == "kalman") return "Kalman filter";
  if (config.kind == "adaptive_window") return "adaptive window";
  return "robust exact";
}

/// Every kind, and the bare first difference beside the filtered one.
std::vector<VelocityRow> contenders(const VelocityEstimator::Config& base) {
  std::vector<VelocityRow> rows;
  const auto add = [&](const VelocityEstimator::Config& config) {
    rows.push_back({.name = name_of(config), .config = config, .linear = is_linear(config)});
  };
  if (base.difference.cutoff_Hz > 0.0) {
    VelocityEstimator::Config bare = base;
    bare.kind = "difference";
    bare.difference.cutoff_Hz = 0.0;
    add(bare);
  }
  for (const std::string_view kind : velocity_kinds()) {
    VelocityEstimator::Config config = base;
    config.kind = kind;
    add(config);
  }
  return rows;
}

double median_dt(const VelocityTrace& trace) {
  std::vector<double> dt;
  dt.reserve(trace.samples.size());
  for (const VelocitySample& sample : trace.samples) {
    dt.push_back(sample.dt);
  }
  const auto middle = dt.begin() + static_cast<std::ptrdiff_t>(dt.size() / 2);
  std::nth_element(dt.begin(), middle, dt.end());
  return *middle;
}

/// At home x, y and z are moved by one joint each.
DampingLoop loop_of(const VelocityOptions& options, const VelocitySource& source) {
  const Matrix3 J = linear_jacobian(source.arm, JointVector::Zero());
  const std::optional<Matrix3> mass = tool_mass(source.arm, JointVector::Zero());
  if (!mass) throw ConfigError{"velocity: the arm's home is a singular posture; give --mass-g"};
  const Matrix3& M = *mass;
  const double period_s = median_dt(source.traces.front());
  DampingLoop loop;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    loop.mass[i] = {.mass_kg = options.mass_g > 0.0 ? 1e-3 * options.mass_g : M(axis, axis),
                    .damping_Ns_per_m = options.damping_Ns_per_m,
                    .period_s = period_s};
    loop.lever_m[i] = std::abs(J(axis, axis));
    loop.counts_per_rev[i] = std::abs(source.traces.front().counts_per_rev[axis]);
    const double quantum_m = loop.lever_m[i] * 2.0 * std::numbers::pi / loop.counts_per_rev[i];
    loop.amplitude_m[i] = options.amplitude_mm > 0.0
                              ? 1e-3 * options.amplitude_mm
                              : std::max(kAmplitude_counts * quantum_m, kLeastAmplitude_m);
  }
  return loop;
}

void limit_damping(const DampingLoop& loop, VelocityRow& row) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double period_s = loop.mass[i].period_s;
    const EvenVelocity estimator{
        .config = row.config, .counts_per_rev = loop.counts_per_rev[i], .period_s = period_s};
    if (row.linear) {
      const std::vector<double> h = impulse_response(estimator);
      row.stated_lag_s = lag_s(h, period_s);
      const auto H = [&](double omega) {
        return response(h, period_s, omega);
      };
      row.limits[i] = damping_limit(loop.mass[i], H, {.highest_Hz = 0.5 / period_s});
      continue;
    }
    const double amplitude_rad = loop.amplitude_m[i] / loop.lever_m[i];
    const auto H = [&](double omega) {
      return describing_function(estimator, amplitude_rad, omega);
    };
    row.limits[i] = damping_limit(loop.mass[i], H,
                                  {.lowest_Hz = 1.0, .highest_Hz = 0.45 / period_s, .points = 80});
  }
}

}  // namespace

std::string velocity_settings(const VelocityOptions& options) {
  VelocityEstimator::Config config;
  return configure(config, options.settings);
}

VelocityStudy study_velocity(const VelocityOptions& options) {
  VelocityEstimator::Config base;
  configure(base, options.settings);
  std::vector<VelocityRow> rows = contenders(base);
  for (const VelocityRow& row : rows) {
    VelocityEstimator{row.config, JointVector::Ones()};  // refuses before anything is read
  }
  VelocityStudy study{.source = load_velocity_source(options)};
  study.loop = loop_of(options, study.source);
  for (VelocityRow& row : rows) {
    fmt::print(stderr, "{} …\n", row.name);
    for (const VelocityTrace& trace : study.source.traces) {
      row.estimates.push_back(run_estimator(row.config, trace));
    }
    row.score = score(study.source.traces, row.estimates);
    limit_damping(study.loop, row);
  }
  study.rows = std::move(rows);
  return study;
}

}  // namespace teleop
