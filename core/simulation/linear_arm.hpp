#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/math/random.hpp"
#include "core/math/spatial.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/simulation/encoder_edges.hpp"
#include "core/simulation/linear_axis.hpp"

namespace teleop {

/// An arm of three independent linear axes behind the port of a device: a plant whose margins and
/// frequency response are known exactly. It stands for a phantom-1.5 at home, where the Jacobian is
/// diagonal; joints map to tool axes x, y, z by
///
///     x_i = r_i q_i,   τ_i = r_i F_i,   r = (l₁, l₁, l₂),
///
/// however far it moves, so code that takes the Jacobian at home once sees a plant that is exactly
/// linear (there is no gravity either). It follows the clock as SimulatedArm does: read and write
/// let it live until clock.now() under the commands that were held. The reading is y plus white
/// noise, to the nearest quantum.
///
/// At most kLongestGap is computed at once; what a longer pause leaves out does not happen.
class LinearArm final : public Arm {
 public:
  struct Config {
    std::array<LinearAxis::Config, kJoints> axes{};
    double quantum_m = 27e-6;  ///< of the reading at the tool
    double noise_std_m = 0.0;  ///< white, in y, before rounding
    double max_force_N = 8.5;  ///< of each axis; more is cut
    std::uint64_t seed = 1;    ///< of the noise
    std::string name = "linear";
  };

  /// What a real arm would not tell, as of the last call of the port; x, y and z.
  struct Truth {
    Vector3 position = Vector3::Zero();  ///< x₁, m
    Vector3 velocity = Vector3::Zero();  ///< ẋ₁, m/s
    Vector3 force = Vector3::Zero();     ///< F, N
    double kinetic_energy_J = 0.0;       ///< of all masses
  };

  static constexpr Duration kLongestGap{100'000'000};

  /// @throws ConfigError: an axis that is not passive, a quantum that is not positive.
  LinearArm(const Config& config, Clock& clock);

  [[nodiscard]] const ArmInfo& info() const noexcept override { return info_; }
  [[nodiscard]] ArmState read() noexcept override;
  void write(const JointVector& tau) noexcept override;
  void amplifiers(bool on) noexcept override;

  [[nodiscard]] Truth true_state() const noexcept;

  /// r: metres at the tool a radian of the joint.
  [[nodiscard]] static JointVector lever_m() noexcept { return {0.215, 0.215, 0.170}; }

 private:
  void live_until(Instant now) noexcept;
  void advance(Duration span) noexcept;

  Config config_;
  std::array<LinearAxis, kJoints> axes_;
  ArmInfo info_;
  EncoderEdges encoder_;
  Random random_;
  Clock* clock_;
  Instant started_;
  Instant now_;
  bool on_ = false;
  bool cut_ = false;
};

}  // namespace teleop
