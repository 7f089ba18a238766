#include "core/diagnosis/exact_reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace teleop {

ExactReading::ExactReading(const PlantTerms& terms, const JointVector& m, const JointVector& md)
    : terms_{&terms} {
  const bool simple = std::all_of(
      terms.sensing.begin(), terms.sensing.end(),
      [](const SensingTerms& axis) { return axis.delay == 0.0 && axis.tendon_stiffness == 0.0; });
  constexpr double kFine = 1e6;  // counts a turn: their edges are not looked at
  if (!simple) late_.emplace(terms.sensing, JointVector::Constant(kFine), m, md);
}

JointVector ExactReading::of(const JointVector& m) const noexcept {
  if (late_) return late_->exact_angles();
  JointVector y = m;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const SensingTerms& sensing = terms_->sensing[i];
    y[axis] *= sensing.scale;
    for (const AngleWave& wave : sensing.waves) {
      y[axis] += wave.amplitude * std::sin(wave.frequency * m[axis] + wave.phase);
    }
  }
  return y;
}

JointVector drive_angle(const PlantTerms& terms, const JointVector& y) noexcept {
  JointVector m = y;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const SensingTerms& sensing = terms.sensing[i];
    for (int pass = 0; pass < 3; ++pass) {
      double waves = 0.0;
      for (const AngleWave& wave : sensing.waves) {
        waves += wave.amplitude * std::sin(wave.frequency * m[axis] + wave.phase);
      }
      m[axis] = (y[axis] - waves) / sensing.scale;
    }
  }
  return m;
}

JointVector start_speed(const Recording& run, double period_s) {
  constexpr std::size_t kReadings = 8;
  const std::size_t n = std::min(kReadings, run.rows());
  if (n < 2) return JointVector::Zero();
  const double middle = static_cast<double>(n - 1) / 2.0;
  JointVector slope = JointVector::Zero();
  double weight = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double x = static_cast<double>(k) - middle;
    slope += x * run.q[k];
    weight += x * x;
  }
  return slope / (weight * period_s);
}

Duration true_period(double period_s, const PlantTerms& terms) {
  return Duration{std::llround(period_s * terms.time_ratio * 1e9)};
}

}  // namespace teleop
