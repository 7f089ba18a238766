#include "core/simulation/sensing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace teleop {
namespace {

constexpr double kEdgesPerLine = 4.0;
constexpr std::size_t kHistory = 4096;  // pieces

std::array<SensingTerms, kJoints> with_interpolation(std::array<SensingTerms, kJoints> terms,
                                                     const JointVector& counts_per_rev) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (terms[i].interpolation_error <= 0.0) continue;
    const double lines = counts_per_rev[static_cast<Eigen::Index>(i)] / kEdgesPerLine;
    // A fifth wave has no room only where four eccentricities were asked for.
    static_cast<void>(terms[i].waves.push(
        {.amplitude = terms[i].interpolation_error * 2.0 * std::numbers::pi / lines,
         .frequency = lines}));
  }
  return terms;
}

JointVector fitted(const std::array<SensingTerms, kJoints>& terms,
                   const JointVector& counts_per_rev) {
  JointVector result = counts_per_rev;
  for (std::size_t i = 0; i < kJoints; ++i) {
    result[static_cast<Eigen::Index>(i)] *= terms[i].steps_per_line / kEdgesPerLine;
  }
  return result;
}

std::array<EncoderEdges::EdgeShifts, kJoints> shifts_of(
    const std::array<SensingTerms, kJoints>& terms) {
  std::array<EncoderEdges::EdgeShifts, kJoints> shifts{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double p = terms[i].phase_error;
    const double d = terms[i].duty_error;
    shifts[i] = {0.0, p, d, p + d};  // channels A and B rise, then fall
  }
  return shifts;
}

bool is_plain(const SensingTerms& terms) {
  return terms.scale == 1.0 && terms.waves.empty() && terms.delay == 0.0 &&
         terms.tendon_stiffness == 0.0;
}

}  // namespace

Sensing::Sensing(const std::array<SensingTerms, kJoints>& terms,
                 const JointVector& counts_per_rev,
                 const JointVector& m,
                 const JointVector& md)
    : terms_{with_interpolation(terms, counts_per_rev)},
      counts_per_rev_{fitted(terms, counts_per_rev)},
      edges_{counts_per_rev_, m, shifts_of(terms)},
      y_{m} {
  JointVector before = m;
  double longest = 0.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    plain_ = plain_ && is_plain(terms_[i]);
    longest = std::max(longest, terms_[i].delay);
    before[axis] = reading(i, m[axis] - terms_[i].delay * md[axis], md[axis]).y;
    shown_until_[i] = -terms_[i].delay;
  }
  y_ = before;
  edges_ = EncoderEdges{counts_per_rev_, before, shifts_of(terms)};
  delays_ = longest > 0.0;
  if (!delays_) return;
  history_.resize(kHistory);
  history_[0] = {.start_s = -longest,
                 .duration_s = longest,
                 .q0 = m - longest * md,
                 .qd0 = md,
                 .q1 = m,
                 .qd1 = md};
  pieces_ = 1;
}

Sensing::Reading Sensing::reading(std::size_t i, double m, double md) const noexcept {
  const SensingTerms& terms = terms_[i];
  Reading result{.y = terms.scale * m, .rate = terms.scale * md};
  for (const AngleWave& wave : terms.waves) {
    const double angle = wave.frequency * m + wave.phase;
    result.y += wave.amplitude * std::sin(angle);
    result.rate += wave.amplitude * wave.frequency * std::cos(angle) * md;
  }
  result.y += tendon_[static_cast<Eigen::Index>(i)];
  return result;
}

void Sensing::observe(const MotionPiece& piece, const JointVector& a) noexcept {
  now_ = piece.start_s + piece.duration_s;
  if (plain_) {
    edges_.observe(piece);
    y_ = piece.q1;
    return;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (terms_[i].tendon_stiffness > 0.0) tendon_[axis] = a[axis] / terms_[i].tendon_stiffness;
  }
  if (delays_) {
    history_[pieces_ % kHistory] = piece;
    ++pieces_;
    catch_up(now_);
  } else {
    show(piece);
  }
}

void Sensing::pass(double now_s) noexcept {
  now_ = now_s;
  if (delays_) catch_up(now_s);
}

void Sensing::show(const MotionPiece& piece) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Reading end = reading(i, piece.q1[axis], piece.qd1[axis]);
    edges_.observe(i, {.start_s = piece.start_s,
                       .duration_s = piece.duration_s,
                       .q0 = y_[axis],
                       .qd0 = reading(i, piece.q0[axis], piece.qd0[axis]).rate,
                       .q1 = end.y,
                       .qd1 = end.rate});
    y_[axis] = end.y;
  }
}

/// Shows each axis its motion up to its delay ago: whole pieces, the last one up to a point of the
/// cubic through its ends.
void Sensing::catch_up(double now_s) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double until = now_s - terms_[i].delay;
    if (pieces_ - next_[i] > kHistory) next_[i] = pieces_ - kHistory;
    while (next_[i] < pieces_) {
      const MotionPiece& piece = history_[next_[i] % kHistory];
      const double end = piece.start_s + piece.duration_s;
      const double from = std::max(shown_until_[i], piece.start_s);
      const double to = std::min(until, end);
      if (to > from) {
        const auto at = [&](double t) noexcept {
          const double h = piece.duration_s;
          const double u = (t - piece.start_s) / h;
          const double rise = piece.q1[axis] - piece.q0[axis];
          const double v0 = piece.qd0[axis] * h;
          const double v1 = piece.qd1[axis] * h;
          const double c2 = 3.0 * rise - 2.0 * v0 - v1;
          const double c3 = v0 + v1 - 2.0 * rise;
          const double m = piece.q0[axis] + u * (v0 + u * (c2 + u * c3));
          return reading(i, m, (v0 + u * (2.0 * c2 + u * 3.0 * c3)) / h);
        };
        const Reading last = at(to);
        edges_.observe(i, {.start_s = from + terms_[i].delay,
                           .duration_s = to - from,
                           .q0 = y_[axis],
                           .qd0 = at(from).rate,
                           .q1 = last.y,
                           .qd1 = last.rate});
        y_[axis] = last.y;
        shown_until_[i] = to;
      }
      if (until < end) break;
      ++next_[i];
    }
  }
}

}  // namespace teleop
