#include "core/estimation/period_velocity.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/estimation/quantum.hpp"

namespace teleop {
namespace {

constexpr double kTick_s = 1e-7;

}  // namespace

PeriodVelocity::PeriodVelocity(const Config& config, const JointVector& counts_per_rev)
    : standstill_s_{config.standstill_ms * 1e-3}, quantum_{encoder_quantum(counts_per_rev)} {
  const bool cancels = config.samples == 1 || config.samples % 4 == 0;
  if (config.samples < 1 || config.samples > kMostSamples || !cancels) {
    throw ConfigError{"velocity estimate: period.samples must be 1 or a multiple of 4 up to 1024"};
  }
  if (!std::isfinite(standstill_s_) || standstill_s_ <= 0.0) {
    throw ConfigError{"velocity estimate: period.standstill_ms must be more than 0"};
  }
  ring_.resize(static_cast<std::size_t>(config.samples), JointVector::Zero());
}

JointVector PeriodVelocity::step(const VelocitySample& sample) noexcept {
  if (state_.has_sample && sample.dt <= 0.0) return state_.qd;
  JointVector speed;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Reading reading{.counts = std::nearbyint(sample.q[row] / quantum_[row]),
                          .ticks = sample.period_ticks[i],
                          .dt = sample.dt};
    Joint& joint = state_.joints[i];
    if (state_.has_sample) update(joint, reading, quantum_[row]);
    joint.counts = reading.counts;
    joint.ticks = reading.ticks;
    speed[row] = joint.speed;
  }
  if (state_.has_sample) average(speed);
  state_.has_sample = true;
  return state_.qd;
}

void PeriodVelocity::update(Joint& joint, const Reading& reading, double step) const noexcept {
  const double moved = reading.counts - joint.counts;
  // A count that went back and forth between two updates shows in the counter alone.
  if (moved != 0.0 || (reading.ticks != 0 && reading.ticks != joint.ticks)) {
    const int sign = reading.ticks > 0 || (reading.ticks == 0 && moved > 0.0) ? 1 : -1;
    const bool turned = joint.direction == -sign && std::abs(moved) < 2.0;
    const double time = reading.ticks == 0 ? (joint.since_s + reading.dt) / std::abs(moved)
                                           : kTick_s * std::abs(reading.ticks);
    joint.speed = turned || moved == 0.0 ? 0.0 : sign * step / time;
    joint.direction = sign;
    joint.since_s = 0.0;
    return;
  }
  joint.since_s += reading.dt;
  const double most = joint.since_s > standstill_s_ ? 0.0 : step / joint.since_s;
  joint.speed = std::clamp(joint.speed, -most, most);
}

void PeriodVelocity::average(const JointVector& speed) noexcept {
  ring_[state_.next] = speed;
  state_.next = (state_.next + 1) % ring_.size();
  state_.filled = std::min(state_.filled + 1, ring_.size());
  JointVector sum = JointVector::Zero();
  for (std::size_t i = 0; i < state_.filled; ++i) {
    sum += ring_[i];
  }
  state_.qd = sum / static_cast<double>(state_.filled);
}

void add_settings(Settings& settings, const std::string& prefix, PeriodVelocity::Config& config) {
  settings.add(prefix + "samples", &config.samples, "period: readings averaged, a multiple of 4",
               {.low = 1, .high = PeriodVelocity::kMostSamples});
  settings.add(prefix + "standstill_ms", &config.standstill_ms,
               "period: an arm without edges for so long stands", kPositive);
}

}  // namespace teleop
