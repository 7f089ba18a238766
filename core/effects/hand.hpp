#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/effects/hand_motion.hpp"
#include "core/math/spatial.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {

/// A hand that holds the tool: a mass that moves with the tool, tied by spring and damper to the
/// point where the hand wants to be,
///
///     f_T = k (p_h − p) + b (v_h − v) − m a,
///
/// the force of the hand on the tool, in B [Hogan 1985]. The plant takes m into its inertia; the
/// hand's weight is carried by the hand itself.
///
/// Defaults are assumed, of the size of a light pen grip: 50 g of fingers move with the stylus;
/// 300 N/m make a press of 3 N, usual at a desk, an intended depth of 10 mm, and with the arm's 77
/// g a resonance near 8 Hz, above voluntary motion; 5 N s/m damp it with ratio 0.4.
///
/// Loop: everything but the constructor is allocation-free, noexcept.
class Hand {
 public:
  struct Config {
    double stiffness_N_per_m = 300.0;
    double damping_Ns_per_m = 5.0;
    double mass_kg = 0.05;
  };

  /// @throws ConfigError when a number is negative or not finite.
  Hand(const Config& config, HandMotion motion);

  /// Goes on to the next interval between two knots; the first one is entered by the constructor.
  void next_interval() noexcept;

  /// Where the hand wants to be, `s` seconds after the interval's first knot.
  [[nodiscard]] HandKnot target(double s) const noexcept {
    return {.p = cubic_[0] + s * (cubic_[1] + s * (cubic_[2] + s * cubic_[3])),
            .v = cubic_[1] + s * (2.0 * cubic_[2] + 3.0 * s * cubic_[3])};
  }

  /// Spring and damper, N.
  [[nodiscard]] Vector3 pull(double s, const Vector3& p_BT, const Vector3& v_BT) const noexcept {
    const HandKnot wanted = target(s);
    return config_.stiffness_N_per_m * (wanted.p - p_BT) +
           config_.damping_Ns_per_m * (wanted.v - v_BT);
  }

  /// Fastest rate at which it moves a tool of that mass and its own, 1/s.
  [[nodiscard]] double rate(double tool_mass_kg) const noexcept;

  [[nodiscard]] const Config& config() const noexcept { return config_; }

 private:
  [[nodiscard]] HandKnot next_knot() noexcept;

  Config config_;
  HandMotion motion_;
  HandKnot end_;                    ///< of the interval
  std::array<Vector3, 4> cubic_{};  ///< of the position in the interval, lowest power first
};

/// A hand by the name that command lines use: "none", "hold" (stays where the tool starts),
/// "reach" (built-in motion), "press" (goes to 10 mm behind the surface of "wall" and "soft" and
/// stays) or the name of a trace file. It starts at rest at `start`.
/// @throws ConfigError as read_hand_trace() does.
[[nodiscard]] std::optional<Hand> make_hand(const std::string& name,
                                            const ArmModel& arm,
                                            const Vector3& start,
                                            std::uint64_t seed,
                                            const Hand::Config& config);

}  // namespace teleop
