#include "core/control/position_error.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

bool is_gain(double value) noexcept { return std::isfinite(value) && value >= 0.0; }

bool is_ratio(double value) noexcept { return std::isfinite(value) && value > 0.0; }

bool equal(double a, double b) noexcept {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

/// One of the two conditions, seen from both sides: k_f g_m against s² g_s.
struct Balance {
  double master = 0.0;
  double slave = 0.0;
};

Balance stiffness_balance(const PositionError::Config& c) noexcept {
  return {.master = c.force_gain * c.stiffness_master_N_per_m,
          .slave = c.scale * c.scale * c.stiffness_slave_N_per_m};
}

Balance damping_balance(const PositionError::Config& c) noexcept {
  return {.master = c.force_gain * c.damping_master_Ns_per_m,
          .slave = c.scale * c.scale * c.damping_slave_Ns_per_m};
}

}  // namespace

PositionError::PositionError(const Config& config, Role role) : config_{config}, role_{role} {
  if (!is_gain(config.stiffness_master_N_per_m) || !is_gain(config.stiffness_slave_N_per_m) ||
      !is_gain(config.damping_master_Ns_per_m) || !is_gain(config.damping_slave_Ns_per_m)) {
    throw ConfigError{"position-error law: stiffness and damping must be 0 or more"};
  }
  if (!is_ratio(config.scale) || !is_ratio(config.force_gain)) {
    throw ConfigError{"position-error law: scale and force_gain must be more than 0"};
  }
  const auto [roll, pitch, yaw] = config.rotation_rad;
  if (!std::isfinite(roll + pitch + yaw)) {
    throw ConfigError{"position-error law: rotation_rad must be three finite angles"};
  }
  R_sm_ = (Eigen::AngleAxisd{yaw, Vector3::UnitZ()} * Eigen::AngleAxisd{pitch, Vector3::UnitY()} *
           Eigen::AngleAxisd{roll, Vector3::UnitX()})
              .toRotationMatrix();
}

PositionError::Coupling PositionError::step(const Motion& own, const Motion& peer) const noexcept {
  const bool is_master = role_ == Role::master;
  const Motion& m = is_master ? own : peer;
  const Motion& s = is_master ? peer : own;
  const Motion wanted = wanted_slave(m);

  const Vector3 e = wanted.displacement - s.displacement;
  const Vector3 ed = wanted.velocity - s.velocity;
  if (!is_master) {
    const Vector3 F_s = config_.stiffness_slave_N_per_m * e + config_.damping_slave_Ns_per_m * ed;
    return {.force = F_s, .error = e, .error_rate = ed};
  }
  const Vector3 pull = config_.stiffness_master_N_per_m * e + config_.damping_master_Ns_per_m * ed;
  const Vector3 F_m = -config_.force_gain / config_.scale * (R_sm_.transpose() * pull);
  return {.force = F_m, .error = e, .error_rate = ed};
}

bool passive(const PositionError::Config& config) noexcept {
  const Balance stiffness = stiffness_balance(config);
  const Balance damping = damping_balance(config);
  return equal(stiffness.master, stiffness.slave) && equal(damping.master, damping.slave);
}

std::string passivity_statement(const PositionError::Config& config) {
  const Balance G = stiffness_balance(config);
  const Balance B = damping_balance(config);
  const auto sign = [](const Balance& b) {
    return equal(b.master, b.slave) ? "=" : "≠";
  };
  return fmt::format(
      "the coupling is {}passive: k_f G_m = {:g} {} s² G_s = {:g} N/m, k_f B_m = {:g} {} s² B_s = "
      "{:g} N s/m{}",
      passive(config) ? "" : "NOT ", G.master, sign(G), G.slave, B.master, sign(B), B.slave,
      passive(config) ? "" : "; it can feed energy into hand and surroundings");
}

void add_settings(Settings& settings, const std::string& prefix, PositionError::Config& config) {
  settings.add(prefix + "stiffness_master_N_per_m", &config.stiffness_master_N_per_m,
               "G_m, coupling spring felt at the master", kNotNegative);
  settings.add(prefix + "stiffness_slave_N_per_m", &config.stiffness_slave_N_per_m,
               "G_s, coupling spring felt at the slave", kNotNegative);
  settings.add(prefix + "damping_master_Ns_per_m", &config.damping_master_Ns_per_m,
               "B_m, coupling damper felt at the master", kNotNegative);
  settings.add(prefix + "damping_slave_Ns_per_m", &config.damping_slave_Ns_per_m,
               "B_s, coupling damper felt at the slave", kNotNegative);
  settings.add(prefix + "scale", &config.scale, "s, slave motion over master motion", kPositive);
  settings.add(prefix + "force_gain", &config.force_gain, "k_f, of the force fed back", kPositive);
  settings.add(prefix + "rotation_rad", &config.rotation_rad,
               "roll, pitch, yaw that turn the master's base into the slave's");
}

}  // namespace teleop
