#include "core/estimation/sine_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace teleop {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTicksPerSecond = 1e7;
constexpr double kOverflowTicks = 65535.0;

}  // namespace

SineEncoder::SineEncoder(const Config& config) : config_{config} {
  const auto first = std::ceil(config.offset_counts - config.amplitude_counts - 0.5);
  const auto last = std::floor(config.offset_counts + config.amplitude_counts - 0.5);
  const auto lines = static_cast<int>(std::max(last - first + 1.0, 0.0));
  for (int i = 0; i < lines; ++i) {
    const double height = first + i + 0.5 - config.offset_counts;
    edges_.push_back(std::asin(std::clamp(height / config.amplitude_counts, -1.0, 1.0)));
  }
  for (int i = lines - 1; i >= 0; --i) {
    edges_.push_back(kPi - edges_[static_cast<std::size_t>(i)]);
  }
}

SineEncoder::Reading SineEncoder::read(double time_s) const noexcept {
  const double phase = config_.omega_rad_per_s * time_s;
  const double x = config_.offset_counts + config_.amplitude_counts * std::sin(phase);
  Reading reading{.counts = std::floor(x + 0.5)};
  if (edges_.size() < 2) return reading;
  const double cycles = std::floor((phase + kPi / 2.0) / (2.0 * kPi));
  const double within = phase - 2.0 * kPi * cycles;
  const auto size = static_cast<std::ptrdiff_t>(edges_.size());
  const auto behind = std::upper_bound(edges_.begin(), edges_.end(), within) - edges_.begin();
  const auto edge = [&](std::ptrdiff_t i) {  // counted on into the cycle before
    return i >= 0 ? edges_[static_cast<std::size_t>(i)]
                  : edges_[static_cast<std::size_t>(i + size)] - 2.0 * kPi;
  };
  const double scale = kTicksPerSecond / config_.omega_rad_per_s;
  const double period = (edge(behind - 1) - edge(behind - 2)) * scale;
  const double since = (within - edge(behind - 1)) * scale;
  if (period > kOverflowTicks || since > kOverflowTicks) return reading;
  const bool rising = behind > 0 && behind <= size / 2;
  const auto ticks = static_cast<std::int32_t>(std::max(std::round(period), 1.0));
  reading.period_ticks = rising ? ticks : -ticks;
  return reading;
}

}  // namespace teleop
