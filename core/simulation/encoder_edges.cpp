#include "core/simulation/encoder_edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace teleop {
namespace {

constexpr double kTicksPerSecond = 1e7;
constexpr double kOverflowTicks = 65535.0;

/// Nearest whole number, for numbers far below 2^51. std::lround is a library call here.
double nearest(double x) noexcept {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kShift) - kShift;
}

}  // namespace

EncoderEdges::EncoderEdges(const JointVector& counts_per_rev,
                           const JointVector& q,
                           const std::array<EdgeShifts, kJoints>& shifts) noexcept
    : shifts_{shifts} {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    counts_per_rad_[i] = counts_per_rev[joint] / (2.0 * std::numbers::pi);
    counts_[i] = count_at(i, q[joint]);
  }
}

/// Where the count changes to the next one, in counts.
double EncoderEdges::edge_above(std::size_t joint, std::int32_t count) const noexcept {
  return static_cast<double>(count) + 0.5 + shifts_[joint][static_cast<std::uint32_t>(count) % 4];
}

std::int32_t EncoderEdges::count_at(std::size_t joint, double q) const noexcept {
  const double x = q * counts_per_rad_[joint];
  const auto count = static_cast<std::int32_t>(nearest(x));
  if (shifts_[joint] == EdgeShifts{}) return count;
  if (x > edge_above(joint, count)) return count + 1;
  if (x < edge_above(joint, count - 1)) return count - 1;
  return count;
}

void EncoderEdges::observe(const MotionPiece& piece) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    observe(i, {.start_s = piece.start_s,
                .duration_s = piece.duration_s,
                .q0 = piece.q0[joint],
                .qd0 = piece.qd0[joint],
                .q1 = piece.q1[joint],
                .qd1 = piece.qd1[joint]});
  }
}

void EncoderEdges::observe(std::size_t joint, const AxisPiece& piece) noexcept {
  Run run{
      .t0 = piece.start_s, .h = piece.duration_s, .q0 = piece.q0, .qd0 = piece.qd0, .q1 = piece.q1};
  if (piece.qd0 * piece.qd1 < 0.0) {
    const double turn = run.h * piece.qd0 / (piece.qd0 - piece.qd1);
    const double q_turn = run.q0 + piece.qd0 * turn / 2.0;
    run_through(joint, {.t0 = run.t0, .h = turn, .q0 = run.q0, .qd0 = run.qd0, .q1 = q_turn});
    run = {.t0 = run.t0 + turn, .h = run.h - turn, .q0 = q_turn, .qd0 = 0.0, .q1 = run.q1};
  }
  run_through(joint, run);
}

void EncoderEdges::run_through(std::size_t joint, const Run& run) noexcept {
  const std::int32_t count = count_at(joint, run.q1);
  const std::int32_t passed = count - counts_[joint];
  if (passed == 0) return;
  counts_[joint] = count;

  const double direction = passed > 0 ? 1.0 : -1.0;
  const double bend = (run.q1 - run.q0 - run.qd0 * run.h) / (run.h * run.h);
  const auto instant = [&](double edge) noexcept {
    const double rise = edge / counts_per_rad_[joint] - run.q0;
    const double slope = std::sqrt(std::max(run.qd0 * run.qd0 + 4.0 * bend * rise, 0.0));
    const double divisor = run.qd0 + direction * slope;
    const double t = divisor == 0.0 ? run.h : 2.0 * rise / divisor;
    return run.t0 + std::clamp(t, 0.0, run.h);
  };
  Edges& edges = edges_[joint];
  const std::int32_t below = passed > 0 ? count - 1 : count;
  const double last = instant(edge_above(joint, below));
  const bool two = passed > 1 || passed < -1;
  const double before =
      two ? instant(edge_above(joint, passed > 0 ? below - 1 : below + 1)) : edges.last_s;
  edges = {.last_s = last, .period_s = last - before, .direction = passed > 0 ? 1 : -1};
}

JointVector EncoderEdges::angles() const noexcept {
  JointVector q;
  for (std::size_t i = 0; i < kJoints; ++i) {
    q[static_cast<Eigen::Index>(i)] = static_cast<double>(counts_[i]) / counts_per_rad_[i];
  }
  return q;
}

std::array<std::int32_t, kJoints> EncoderEdges::period_ticks(double now_s) const noexcept {
  std::array<std::int32_t, kJoints> ticks{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Edges& edges = edges_[i];
    const double period = edges.period_s * kTicksPerSecond;
    const double since = (now_s - edges.last_s) * kTicksPerSecond;
    if (period > kOverflowTicks || since > kOverflowTicks) continue;
    // Two edges within one tick read as one tick: 0 means overflow.
    const auto whole = static_cast<std::int32_t>(std::max(nearest(period), 1.0));
    ticks[i] = edges.direction * whole;
  }
  return ticks;
}

}  // namespace teleop
