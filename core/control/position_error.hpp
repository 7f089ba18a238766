#pragma once

#include <array>
#include <string>

#include "core/base/settings.hpp"
#include "core/math/spatial.hpp"
#include "core/ports/peer.hpp"

namespace teleop {

/// Position-error force feedback [Cavusoglu 2002, fig. 6, in general form]: each tool is tied to
/// the other by a spring and a damper,
///
///     e   = s R (x_m − x_m0) − (x_s − x_s0)
///     F_s =  G_s e + B_s ė
///     F_m = −(k_f / s) Rᵀ (G_m e + B_m ė)
///
/// s scales master motion to slave motion, R turns the master's base into the slave's. Forces act
/// on the own tool and are expressed in the own base; e is expressed in the slave's base. The
/// coupling stores ½ G_s |e|² and burns B_s |ė|², so it is passive, if and only if
///
///     k_f G_m = s² G_s   and   k_f B_m = s² B_s.
///
/// The shipped gains: B was chosen, G is half of the marginal gain that the tuner finds on the
/// shipped phantom-1.5 at the worst pose (tests/tuner/shipped_gains_test.cpp, docs/theory.md).
/// Thread: any. Loop: step neither allocates, blocks nor throws.
class PositionError {
 public:
  struct Config {
    double stiffness_master_N_per_m = 1300.0;
    double stiffness_slave_N_per_m = 1300.0;
    double damping_master_Ns_per_m = 3.0;
    double damping_slave_Ns_per_m = 3.0;
    double scale = 1.0;                    ///< s
    double force_gain = 1.0;               ///< k_f
    std::array<double, 3> rotation_rad{};  ///< roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll)
  };

  /// Motion of one tool since its reference was taken, in its own base.
  struct Motion {
    Vector3 displacement = Vector3::Zero();  ///< x − x_0, m
    Vector3 velocity = Vector3::Zero();      ///< m/s
  };

  struct Coupling {
    Vector3 force = Vector3::Zero();       ///< on the own tool, N
    Vector3 error = Vector3::Zero();       ///< e, m
    Vector3 error_rate = Vector3::Zero();  ///< ė, m/s
  };

  /// @throws ConfigError unless every number is finite, s and k_f are positive and no gain is
  ///         negative.
  PositionError(const Config& config, Role role);

  /// The own side's force. The law has no memory.
  [[nodiscard]] Coupling step(const Motion& own, const Motion& peer) const noexcept;

  /// Where the law wants the slave, since its reference: s R times the master's motion.
  [[nodiscard]] Motion wanted_slave(const Motion& master) const noexcept {
    return {.displacement = config_.scale * (R_sm_ * master.displacement),
            .velocity = config_.scale * (R_sm_ * master.velocity)};
  }

  [[nodiscard]] const Matrix3& rotation() const noexcept { return R_sm_; }  ///< R
  [[nodiscard]] Role role() const noexcept { return role_; }
  [[nodiscard]] const Config& config() const noexcept { return config_; }

 private:
  Config config_;
  Role role_;
  Matrix3 R_sm_;  ///< master base to slave base
};

/// Whether the coupling can only store and burn energy (to 1e-9 of the larger side).
[[nodiscard]] bool passive(const PositionError::Config& config) noexcept;

/// The same in one line of words and numbers, to be shown before the loop starts.
[[nodiscard]] std::string passivity_statement(const PositionError::Config& config);

void add_settings(Settings& settings, const std::string& prefix, PositionError::Config& config);

}  // namespace teleop
