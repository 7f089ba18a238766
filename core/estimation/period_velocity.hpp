#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/settings.hpp"
#include "core/estimation/velocity_sample.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Joint velocity from a counter of the time between encoder edges (10 MHz, 16 bits), averaged over
/// N updates of the loop [Cavusoglu 2002, section 4.2.2]. With Δ = 2π / counts_per_rev one update
/// reads, a joint at a time,
///
///     new edge, counter valid    ± Δ / period, the sign from the counter
///     new edge, overflow         Δ · counts / t_e
///     new edge after a turn      0
///     no new edge                the reading before, cut to ± Δ / t_e; 0 when t_e > standstill
///
/// where t_e is the loop's own time since the update that saw the last edge. A speed below
/// Δ/6.55 ms (4.6 mm/s for 30 µm) overflows the counter: there the loop's clock measures the
/// period, the better the slower. After a turn both edges are one line of the encoder: nothing was
/// covered between them. Without an edge the speed cannot have been more than Δ/t_e, so an arm that
/// stops is followed down to zero.
///
/// Lag: (N − 1) Δt/2 of the average and about one period of the edges, half of it for the period
/// measured and half for its age. The spacing of the edges of one quadrature cycle differs;
/// averages of a multiple of four edges do not see that (to first order), hence N = 16.
///
/// An arm without such a counter (ticks always 0) is seen through counts and the loop's clock
/// alone. Thread: the loop's only. Loop: step and reset neither allocate, block nor throw.
class PeriodVelocity {
 public:
  struct Config {
    int samples = 16;              ///< N, 1 or a multiple of four
    double standstill_ms = 100.0;  ///< an arm without edges for so long stands
  };

  static constexpr int kMostSamples = 1024;

  /// @throws ConfigError when N is not usable or counts_per_rev is zero on a joint.
  PeriodVelocity(const Config& config, const JointVector& counts_per_rev);

  /// The estimate after a sample, rad/s. The first sample gives zero; so does one that follows
  /// reset(). With dt ≤ 0 nothing changes.
  JointVector step(const VelocitySample& sample) noexcept;

  void reset() noexcept { state_ = {}; }

 private:
  /// What is known of one joint's edges.
  struct Joint {
    double counts = 0.0;
    std::int32_t ticks = 0;
    int direction = 0;     ///< of the last edge, 0 before the first
    double since_s = 0.0;  ///< t_e
    double speed = 0.0;    ///< of this update, rad/s
  };
  struct State {
    std::array<Joint, kJoints> joints{};
    std::size_t next = 0;    ///< place in the ring
    std::size_t filled = 0;  ///< readings in the ring
    bool has_sample = false;
    JointVector qd = JointVector::Zero();
  };

  /// One joint, one update.
  struct Reading {
    double counts = 0.0;
    std::int32_t ticks = 0;
    double dt = 0.0;
  };

  void update(Joint& joint, const Reading& reading, double step) const noexcept;
  void average(const JointVector& speed) noexcept;

  double standstill_s_;
  JointVector quantum_;            // Δ, rad
  std::vector<JointVector> ring_;  // the last N readings
  State state_{};
};

void add_settings(Settings& settings, const std::string& prefix, PeriodVelocity::Config& config);

}  // namespace teleop
