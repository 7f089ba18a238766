#pragma once

#include <array>
#include <string>

#include "core/base/settings.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// The parameters of a PHANToM as an arm file gives them (scenarios/arms/*.toml). Link names as in
/// [Cavusoglu 2002, fig. 2 and appendix]: a forearm, c parallelogram link, be link B with motor E,
/// df crank F with motor D, base the yawing base. SI units.
struct ArmParameters {
  std::string name;    ///< "phantom-1.5"
  std::string source;  ///< where the numbers come from

  double l1_m = 0.0;  ///< upper arm
  double l2_m = 0.0;  ///< forearm
  double l3_m = 0.0;  ///< crank
  double l5_m = 0.0;  ///< shoulder to the mass centre of be, along the upper arm (negative: behind)
  double l6_m = 0.0;  ///< shoulder to the mass centre of df, opposite to the forearm
  double ma_kg = 0.0;
  double mc_kg = 0.0;
  double mbe_kg = 0.0;
  double mdf_kg = 0.0;
  std::array<double, 3> Ia_kg_m2{};   ///< (xx, yy, zz) about the own mass centre
  std::array<double, 3> Ic_kg_m2{};   ///< about the own mass centre
  std::array<double, 3> Ibe_kg_m2{};  ///< about the shoulder
  std::array<double, 3> Idf_kg_m2{};  ///< about the shoulder
  double Ibase_kg_m2 = 0.0;           ///< yaw
  double gravity_m_per_s2 = 9.81;     ///< along −y

  std::array<double, 3> lower_limit_rad{};  ///< joint stops
  std::array<double, 3> upper_limit_rad{};
  double max_q2_minus_q3_rad = 0.0;  ///< coupled stops of the parallelogram
  double max_q3_minus_q2_rad = 0.0;
  std::array<double, 3> encoder_counts_per_rev{};  ///< of the joint, quadrature counted
  std::array<double, 3> transmission_ratio{};      ///< motor turns a joint turn
  std::array<double, 3> torque_constant_Nm_per_A{};
  std::array<double, 3> max_torque_Nm{};  ///< at the joint, peak
  double max_force_N = 0.0;               ///< at the tool, peak
};

/// Adds every parameter as a setting, so that arm files are read and checked like any other file.
/// The ranges given here are also the ones that ArmModel checks.
void add_settings(Settings& settings, const std::string& prefix, ArmParameters& arm);

/// Constant model of one arm: the parameters and the few lumped constants that the equations need.
/// Made once, shared by everyone; every function of kinematics.hpp and dynamics.hpp takes it first.
class ArmModel {
 public:
  /// @throws ConfigError when a parameter is out of its range (lengths, masses and inertias are
  ///         positive, which makes M(q) positive definite everywhere) or limits are out of order.
  explicit ArmModel(const ArmParameters& parameters);

  [[nodiscard]] const ArmParameters& parameters() const noexcept { return parameters_; }

  /// Lumped constants of M, C and N [Cavusoglu 2002, section 3; restated in docs/theory.md]:
  ///     M11 = S0 + S2 cos 2q2 − S3 cos 2q3 + K cos q2 sin q3,   M23 = −(K/2) sin(q2 − q3),
  ///     U = N2 sin q2 − N3 cos q3.
  struct Lumped {
    double K = 0.0;    ///< l1 (l2 ma + l3 mc), kg m²
    double S0 = 0.0;   ///< kg m²; S0, S2 and S3 hold the factor 1/8 of the paper's M11
    double S2 = 0.0;   ///< kg m²
    double S3 = 0.0;   ///< kg m²
    double M22 = 0.0;  ///< kg m²
    double M33 = 0.0;  ///< kg m²
    double N2 = 0.0;   ///< N m, gravity torque 2 is N2 cos q2
    double N3 = 0.0;   ///< N m, gravity torque 3 is N3 sin q3
  };
  [[nodiscard]] const Lumped& lumped() const noexcept { return lumped_; }

  /// The same arm with other lumped constants, as an identification finds them.
  [[nodiscard]] ArmModel with(const Lumped& lumped) const {
    ArmModel other = *this;
    other.lumped_ = lumped;
    return other;
  }

 private:
  ArmParameters parameters_;
  Lumped lumped_;
};

/// Reads an arm file, which has to give every parameter. `name` is a path ending in .toml or the
/// name of a shipped arm ("phantom-1.5").
/// @throws ConfigError naming the file, and the line or the key.
[[nodiscard]] ArmModel load_arm(const std::string& name);

}  // namespace teleop
