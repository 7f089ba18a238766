#pragma once

#include <array>
#include <cstdint>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// A stretch of motion without any event: the state at both ends.
struct MotionPiece {
  double start_s = 0.0;  ///< since the plant's start
  double duration_s = 0.0;
  JointVector q0 = JointVector::Zero();
  JointVector qd0 = JointVector::Zero();
  JointVector q1 = JointVector::Zero();
  JointVector qd1 = JointVector::Zero();
};

/// The same of one axis.
struct AxisPiece {
  double start_s = 0.0;
  double duration_s = 0.0;
  double q0 = 0.0;
  double qd0 = 0.0;
  double q1 = 0.0;
  double qd1 = 0.0;
};

/// Incremental encoders with a period counter as the paper's electronics have: counts to the
/// nearest step of angle, and 10 MHz ticks between the last two edges, signed with the direction of
/// the last, 0 when the 16-bit counter overflowed between them or since (6.55 ms) [Cavusoglu 2002,
/// section 5]. Instants of edges come from the parabola through a piece's ends and its first speed.
/// The four edges of a line may be unevenly spaced.
/// Loop: allocation-free, noexcept.
class EncoderEdges {
 public:
  /// Shifts of the four edges of a line, in counts, each below half a count.
  using EdgeShifts = std::array<double, 4>;

  EncoderEdges(const JointVector& counts_per_rev,
               const JointVector& q,
               const std::array<EdgeShifts, kJoints>& shifts = {}) noexcept;

  void observe(const MotionPiece& piece) noexcept;
  void observe(std::size_t joint, const AxisPiece& piece) noexcept;

  [[nodiscard]] const std::array<std::int32_t, kJoints>& counts() const noexcept { return counts_; }
  [[nodiscard]] JointVector angles() const noexcept;
  [[nodiscard]] std::array<std::int32_t, kJoints> period_ticks(double now_s) const noexcept;

 private:
  struct Edges {
    double last_s = -1.0;   ///< instant of the last edge
    double period_s = 1.0;  ///< between the last two; so long that it overflowed
    int direction = 1;
  };

  /// One joint from t0 for h seconds, without a turn between.
  struct Run {
    double t0 = 0.0;
    double h = 0.0;
    double q0 = 0.0;
    double qd0 = 0.0;
    double q1 = 0.0;
  };
  void run_through(std::size_t joint, const Run& run) noexcept;
  [[nodiscard]] double edge_above(std::size_t joint, std::int32_t count) const noexcept;
  [[nodiscard]] std::int32_t count_at(std::size_t joint, double q) const noexcept;

  std::array<double, kJoints> counts_per_rad_{};
  std::array<EdgeShifts, kJoints> shifts_{};
  std::array<std::int32_t, kJoints> counts_{};
  std::array<Edges, kJoints> edges_{};
};

}  // namespace teleop
