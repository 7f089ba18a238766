#pragma once

#include <cstddef>
#include <vector>

namespace teleop {

/// Holds an axis whose reading comes late to its recording. What an innovation says is about the
/// axis as it was; carried forward by
///
///     q⁺ = q + h v + h²/2 W d,   v⁺ = v + h W d,   d⁺ = φ d
///
/// it moves the axis as it is, and until the moved axis is read the readings in between are moved
/// in its stead: otherwise the same error would be corrected again and again.
class LateAxis {
 public:
  /// Angle, speed and disturbance torque, or what is added to them.
  struct State {
    double q = 0.0;
    double v = 0.0;
    double d = 0.0;
  };

  struct Config {
    double delay_s = 0.0;
    double period_s = 1e-3;
    double mobility = 0.0;  ///< W, of the axis
    double memory = 0.0;    ///< φ, a sample
  };

  LateAxis() = default;  ///< not late
  explicit LateAxis(const Config& config);

  [[nodiscard]] bool is_late() const noexcept { return !underway_.empty(); }

  /// To be added to the reading that the simulation gives, rad.
  [[nodiscard]] double pending() const noexcept { return then_.q; }

  /// Takes in what a reading says of the axis as it was.
  /// @returns what is to be added to the axis as it is
  State take(const State& correction) noexcept;

 private:
  [[nodiscard]] State carried(const State& state, double time_s, double memory) const noexcept;

  Config config_{};
  std::size_t pieces_ = 0;
  std::vector<State> underway_{};  ///< a ring: added to the axis, not yet read
  std::size_t next_ = 0;
  State then_{};  ///< by which the axis, as it is read now, is better known than simulated
};

}  // namespace teleop
