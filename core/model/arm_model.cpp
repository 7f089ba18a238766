#include "core/model/arm_model.hpp"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

void add_bodies(Settings& settings, const std::string& prefix, ArmParameters& arm) {
  const std::string geometry = prefix + "geometry.";
  settings.add(geometry + "l1_m", &arm.l1_m, "upper arm", kPositive);
  settings.add(geometry + "l2_m", &arm.l2_m, "forearm", kPositive);
  settings.add(geometry + "l3_m", &arm.l3_m, "crank of the parallelogram", kPositive);
  settings.add(geometry + "l5_m", &arm.l5_m, "shoulder to the mass centre of be");
  settings.add(geometry + "l6_m", &arm.l6_m, "shoulder to the mass centre of df");
  const std::string mass = prefix + "mass.";
  settings.add(mass + "ma_kg", &arm.ma_kg, "forearm", kPositive);
  settings.add(mass + "mc_kg", &arm.mc_kg, "parallelogram link", kPositive);
  settings.add(mass + "mbe_kg", &arm.mbe_kg, "link B with motor E", kPositive);
  settings.add(mass + "mdf_kg", &arm.mdf_kg, "crank F with motor D", kPositive);
  const std::string inertia = prefix + "inertia.";
  settings.add(inertia + "Ia_kg_m2", &arm.Ia_kg_m2, "forearm, own centre", kPositive);
  settings.add(inertia + "Ic_kg_m2", &arm.Ic_kg_m2, "link C, own centre", kPositive);
  settings.add(inertia + "Ibe_kg_m2", &arm.Ibe_kg_m2, "be, about the shoulder", kPositive);
  settings.add(inertia + "Idf_kg_m2", &arm.Idf_kg_m2, "df, about the shoulder", kPositive);
  settings.add(inertia + "Ibase_kg_m2", &arm.Ibase_kg_m2, "base, yaw", kPositive);
}

void add_limits(Settings& settings, const std::string& prefix, ArmParameters& arm) {
  const std::string limits = prefix + "limits.";
  settings.add(limits + "lower_rad", &arm.lower_limit_rad, "joint stops");
  settings.add(limits + "upper_rad", &arm.upper_limit_rad, "joint stops");
  settings.add(limits + "q2_minus_q3_rad", &arm.max_q2_minus_q3_rad, "largest q2 - q3");
  settings.add(limits + "q3_minus_q2_rad", &arm.max_q3_minus_q2_rad, "largest q3 - q2");
  settings.add(limits + "torque_Nm", &arm.max_torque_Nm, "peak, at the joints", kPositive);
  settings.add(limits + "force_N", &arm.max_force_N, "peak, at the tool", kPositive);
  const std::string drive = prefix + "drive.";
  settings.add(drive + "encoder_counts_per_rev", &arm.encoder_counts_per_rev,
               "of the joint, quadrature counted", kPositive);
  settings.add(drive + "transmission_ratio", &arm.transmission_ratio, "motor turns a joint turn",
               kPositive);
  settings.add(drive + "torque_constant_Nm_per_A", &arm.torque_constant_Nm_per_A, "of the motors",
               kPositive);
}

/// The range of a setting, for parameters that did not come through a file.
void check(const Setting& setting, double value, const std::string& arm) {
  if (std::isfinite(value) && value >= setting.range.low && value <= setting.range.high) return;
  throw ConfigError{fmt::format("arm '{}': {} = {}: must be {}", arm, setting.key, setting.value(),
                                setting.range.low > 0.0 ? "more than 0" : "a finite number")};
}

void check_ranges(ArmParameters& arm) {
  Settings settings;
  add_settings(settings, "", arm);
  for (const Setting& setting : settings.list()) {
    if (double* const* value = std::get_if<double*>(&setting.target)) {
      check(setting, **value, arm.name);
    } else if (auto* const* values = std::get_if<std::array<double, 3>*>(&setting.target)) {
      for (const double each : **values) {
        check(setting, each, arm.name);
      }
    }
  }
}

void check_limits_in_order(const ArmParameters& arm) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (arm.lower_limit_rad.at(i) >= arm.upper_limit_rad.at(i)) {
      throw ConfigError{fmt::format(
          "arm '{}': limits.lower_rad of joint {} = {}: must be below limits.upper_rad = {}",
          arm.name, i + 1, arm.lower_limit_rad.at(i), arm.upper_limit_rad.at(i))};
    }
  }
  if (-arm.max_q2_minus_q3_rad >= arm.max_q3_minus_q2_rad) {
    throw ConfigError{fmt::format(
        "arm '{}': limits.q2_minus_q3_rad = {}, limits.q3_minus_q2_rad = {}: their sum must be "
        "more than 0",
        arm.name, arm.max_q2_minus_q3_rad, arm.max_q3_minus_q2_rad)};
  }
}

ArmModel::Lumped lump(const ArmParameters& arm) {
  const auto [Iaxx, Iayy, Iazz] = arm.Ia_kg_m2;
  const auto [Icxx, Icyy, Iczz] = arm.Ic_kg_m2;
  const auto [Ibexx, Ibeyy, Ibezz] = arm.Ibe_kg_m2;
  const auto [Idfxx, Idfyy, Idfzz] = arm.Idf_kg_m2;
  const double ma = arm.ma_kg;
  const double mc = arm.mc_kg;
  const double l1_squared = arm.l1_m * arm.l1_m;
  const double l2_squared = arm.l2_m * arm.l2_m;
  const double l3_squared = arm.l3_m * arm.l3_m;
  const double upper = l1_squared * (4.0 * ma + mc);
  const double fore = l2_squared * ma + 4.0 * l3_squared * mc;
  const double g = arm.gravity_m_per_s2;
  return {
      .K = arm.l1_m * (arm.l2_m * ma + arm.l3_m * mc),
      .S0 = (Iayy + Iazz + Ibeyy + Ibezz + Icyy + Iczz + Idfyy + Idfzz) / 2.0 + arm.Ibase_kg_m2 +
            (upper + fore) / 8.0,
      .S2 = (Ibeyy - Ibezz + Icyy - Iczz) / 2.0 + upper / 8.0,
      .S3 = (Iazz - Iayy + Idfzz - Idfyy) / 2.0 + fore / 8.0,
      .M22 = Ibexx + Icxx + upper / 4.0,
      .M33 = Iaxx + Idfxx + fore / 4.0,
      .N2 = g * (arm.l1_m * ma + arm.l5_m * arm.mbe_kg + arm.l1_m * mc / 2.0),
      .N3 = g * (arm.l2_m * ma / 2.0 + arm.l3_m * mc - arm.l6_m * arm.mdf_kg),
  };
}

}  // namespace

void add_settings(Settings& settings, const std::string& prefix, ArmParameters& arm) {
  settings.add(prefix + "name", &arm.name, "of the arm");
  settings.add(prefix + "source", &arm.source, "where the numbers come from");
  settings.add(prefix + "gravity_m_per_s2", &arm.gravity_m_per_s2, "along -y", kNotNegative);
  add_bodies(settings, prefix, arm);
  add_limits(settings, prefix, arm);
}

ArmModel::ArmModel(const ArmParameters& parameters)
    : parameters_{parameters}, lumped_{lump(parameters)} {
  check_ranges(parameters_);
  check_limits_in_order(parameters_);
}

ArmModel load_arm(const std::string& name) {
  const fs::path file =
      data_file(name.ends_with(".toml") ? fs::path{name} : fs::path{"arms"} / (name + ".toml"));
  ArmParameters parameters;
  Settings settings;
  add_settings(settings, "", parameters);
  settings.load(file);
  for (const Setting& setting : settings.list()) {
    if (setting.origin != "default") continue;
    throw ConfigError{
        fmt::format("{}: {} is missing ({})", file.string(), setting.key, setting.text)};
  }
  try {
    return ArmModel{parameters};
  } catch (const ConfigError& error) {
    throw ConfigError{fmt::format("{}: {}", file.string(), error.what())};
  }
}

}  // namespace teleop
