#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/math/random.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// Where a hand wants the tool to be, at knots one kKnotPeriod apart; cubic Hermite between them.
/// Positions in the arm's base B, m and m/s.
struct HandKnot {
  Vector3 p = Vector3::Zero();
  Vector3 v = Vector3::Zero();
};

inline constexpr Duration kKnotPeriod{1'000'000};

/// 0 to 1 for u from 0 to 1 at rest and without acceleration at both ends, the path of least jerk
/// [Flash, Hogan 1985]: 10 u³ − 15 u⁴ + 6 u⁵.
[[nodiscard]] double minimum_jerk(double u) noexcept;
[[nodiscard]] double minimum_jerk_rate(double u) noexcept;

/// Each motion below hands out its knots one after the other, without end, the first at time zero.
/// Loop: next() is allocation-free, noexcept.

/// From one point to another along a path of least jerk, then at rest there.
class PointMotion {
 public:
  PointMotion(const Vector3& from, const Vector3& to, Duration duration);
  [[nodiscard]] HandKnot next() noexcept;

 private:
  Vector3 from_;
  Vector3 to_;
  double knots_;
  double knot_ = 0.0;
};

/// A recorded motion over and over: one second of approach from rest at `from`, then the loop.
class RepeatedMotion {
 public:
  /// @pre loop is not empty; its last knot is one period before its first.
  RepeatedMotion(const Vector3& from, std::vector<HandKnot> loop);
  [[nodiscard]] HandKnot next() noexcept;

 private:
  [[nodiscard]] HandKnot approach(double t) const noexcept;

  Vector3 from_;
  std::vector<HandKnot> loop_;
  std::size_t knot_ = 0;
};

/// A hand at work: reaches of least jerk between seeded targets in a box, at about 0.12 m/s with
/// pauses between, under physiological tremor of 8 to 12 Hz, 0.1 mm RMS an axis. The tremor grows
/// from zero in the first second, so the hand starts at rest at the box's centre.
class ReachMotion {
 public:
  struct Config {
    Vector3 centre_m = Vector3::Zero();
    Vector3 half_size_m{0.06, 0.04, 0.04};
    double speed_m_per_s = 0.12;  ///< mean of a reach
    double tremor_rms_m = 1e-4;   ///< an axis
    std::uint64_t seed = 1;
  };

  explicit ReachMotion(const Config& config);
  [[nodiscard]] HandKnot next() noexcept;

 private:
  /// A sinusoid that turns by a fixed angle a knot.
  struct Oscillator {
    double cosine = 1.0;
    double sine = 0.0;
    double turn_cosine = 1.0;
    double turn_sine = 0.0;
    double frequency = 0.0;  ///< rad/s
  };
  static constexpr std::size_t kOscillators = 3;  ///< an axis

  void choose_reach() noexcept;
  [[nodiscard]] HandKnot tremor() noexcept;

  Config config_;
  Random random_;
  std::array<std::array<Oscillator, kOscillators>, 3> oscillators_{};
  Vector3 from_;
  Vector3 to_;
  double reach_knots_ = 1.0;
  double pause_knots_ = 0.0;
  double knot_ = 0.0;     ///< of the reach
  double started_ = 0.0;  ///< knots since the start, until the tremor has grown
};

using HandMotion = std::variant<PointMotion, RepeatedMotion, ReachMotion>;

}  // namespace teleop
