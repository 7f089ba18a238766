#include "core/effects/hand_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

// In seconds, where not in knots.
constexpr double kKnot = seconds(kKnotPeriod);
constexpr double kGrowthKnots = 1000.0;
constexpr std::size_t kApproachKnots = 1000;
constexpr double kApproach = kKnot * static_cast<double>(kApproachKnots);
constexpr double kShortestReach = 0.4;

HandKnot point_between(const Vector3& from, const Vector3& to, double u, double duration) noexcept {
  return {.p = from + minimum_jerk(u) * (to - from),
          .v = minimum_jerk_rate(u) / duration * (to - from)};
}

}  // namespace

double minimum_jerk(double u) noexcept {
  const double x = std::clamp(u, 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

double minimum_jerk_rate(double u) noexcept {
  const double x = std::clamp(u, 0.0, 1.0);
  return 30.0 * x * x * (1.0 - x) * (1.0 - x);
}

PointMotion::PointMotion(const Vector3& from, const Vector3& to, Duration duration)
    : from_{from}, to_{to}, knots_{seconds(duration) / kKnot} {
  expects(knots_ > 0.0, "a motion takes time");
}

HandKnot PointMotion::next() noexcept {
  const HandKnot knot = point_between(from_, to_, knot_ / knots_, knots_ * kKnot);
  knot_ = std::min(knot_ + 1.0, knots_);
  return knot;
}

RepeatedMotion::RepeatedMotion(const Vector3& from, std::vector<HandKnot> loop)
    : from_{from}, loop_{std::move(loop)} {
  expects(!loop_.empty(), "a repeated motion has knots");
}

/// The path of least jerk to the loop's first knot, and in its last kEntry the one quintic that
/// is zero but for the speed 1 at its end, so that the loop is entered at its own speed.
HandKnot RepeatedMotion::approach(double t) const noexcept {
  constexpr double kEntry = 0.2;
  HandKnot knot = point_between(from_, loop_.front().p, t / kApproach, kApproach);
  const double u = std::max(0.0, 1.0 - (kApproach - t) / kEntry);
  const double entry = u * u * u * (-4.0 + u * (7.0 - 3.0 * u));
  const double entry_rate = u * u * (-12.0 + u * (28.0 - 15.0 * u));
  knot.p += entry * kEntry * loop_.front().v;
  knot.v += entry_rate * loop_.front().v;
  return knot;
}

HandKnot RepeatedMotion::next() noexcept {
  const std::size_t knot = knot_++;
  if (knot < kApproachKnots) {
    return approach(kKnot * static_cast<double>(knot));
  }
  if (knot_ == kApproachKnots + loop_.size()) knot_ = kApproachKnots;
  return loop_[knot - kApproachKnots];
}

ReachMotion::ReachMotion(const Config& config)
    : config_{config}, random_{config.seed}, from_{config.centre_m}, to_{config.centre_m} {
  for (auto& axis : oscillators_) {
    for (Oscillator& each : axis) {
      const double phase = random_.uniform(0.0, 2.0 * std::numbers::pi);
      each.frequency = 2.0 * std::numbers::pi * random_.uniform(8.0, 12.0);
      each.cosine = std::cos(phase);
      each.sine = std::sin(phase);
      each.turn_cosine = std::cos(each.frequency * kKnot);
      each.turn_sine = std::sin(each.frequency * kKnot);
    }
  }
  choose_reach();
}

void ReachMotion::choose_reach() noexcept {
  from_ = to_;
  for (Eigen::Index i = 0; i < 3; ++i) {
    to_[i] = config_.centre_m[i] + config_.half_size_m[i] * random_.uniform(-1.0, 1.0);
  }
  const double duration = std::max(kShortestReach, (to_ - from_).norm() / config_.speed_m_per_s);
  reach_knots_ = std::round(duration / kKnot);
  pause_knots_ = std::round(random_.uniform(0.15, 0.5) / kKnot);
  knot_ = 0.0;
}

HandKnot ReachMotion::tremor() noexcept {
  const double size = config_.tremor_rms_m * std::sqrt(2.0 / static_cast<double>(kOscillators));
  HandKnot sum;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Oscillator& each : oscillators_[static_cast<std::size_t>(i)]) {
      sum.p[i] += size * each.sine;
      sum.v[i] += size * each.frequency * each.cosine;
      const double cosine = each.cosine * each.turn_cosine - each.sine * each.turn_sine;
      each.sine = each.sine * each.turn_cosine + each.cosine * each.turn_sine;
      each.cosine = cosine;
    }
  }
  return sum;
}

HandKnot ReachMotion::next() noexcept {
  HandKnot knot = point_between(from_, to_, knot_ / reach_knots_, reach_knots_ * kKnot);
  HandKnot shake = tremor();
  if (started_ < kGrowthKnots) {
    const double growth = minimum_jerk(started_ / kGrowthKnots);
    const double rate = minimum_jerk_rate(started_ / kGrowthKnots) / (kGrowthKnots * kKnot);
    shake.v = growth * shake.v + rate * shake.p;
    shake.p *= growth;
    started_ += 1.0;
  }
  knot.p += shake.p;
  knot.v += shake.v;
  knot_ += 1.0;
  if (knot_ >= reach_knots_ + pause_knots_) choose_reach();
  return knot;
}

}  // namespace teleop
