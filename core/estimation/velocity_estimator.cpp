#include "core/estimation/velocity_estimator.hpp"

#include <array>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr std::array<std::string_view, 6> kKinds{
    "difference", "mean", "period", "kalman", "adaptive_window", "robust_exact"};

std::string kinds_text() {
  std::string text;
  for (const std::string_view kind : kKinds) {
    text += (text.empty() ? "" : ", ") + std::string{kind};
  }
  return text;
}

}  // namespace

std::span<const std::string_view> velocity_kinds() noexcept { return kKinds; }

VelocityEstimator::VelocityEstimator(const Config& config, const JointVector& counts_per_rev)
    : estimator_{make(config, counts_per_rev)} {}

VelocityEstimator::Estimator VelocityEstimator::make(const Config& config,
                                                     const JointVector& counts_per_rev) {
  if (config.kind == "difference") return DifferenceVelocity{config.difference};
  if (config.kind == "mean") return MeanVelocity{config.mean};
  if (config.kind == "period") return PeriodVelocity{config.period, counts_per_rev};
  if (config.kind == "kalman") return KalmanVelocity{config.kalman, counts_per_rev};
  if (config.kind == "adaptive_window") return WindowVelocity{config.window, counts_per_rev};
  if (config.kind == "robust_exact") return RobustVelocity{config.robust};
  throw ConfigError{"velocity estimate: no kind '" + config.kind + "'; there are " + kinds_text()};
}

// The variant is never without a value, so visiting it cannot throw.
// NOLINTNEXTLINE(bugprone-exception-escape)
JointVector VelocityEstimator::step(const VelocitySample& sample) noexcept {
  return std::visit([&](auto& estimator) { return estimator.step(sample); }, estimator_);
}

// NOLINTNEXTLINE(bugprone-exception-escape): as above
void VelocityEstimator::reset() noexcept {
  std::visit([](auto& estimator) { estimator.reset(); }, estimator_);
}

void add_settings(Settings& settings,
                  const std::string& prefix,
                  VelocityEstimator::Config& config) {
  settings.add(prefix + "kind", &config.kind, "velocity estimate: " + kinds_text());
  add_settings(settings, prefix, config.difference);
  add_settings(settings, prefix + "mean.", config.mean);
  add_settings(settings, prefix + "period.", config.period);
  add_settings(settings, prefix + "kalman.", config.kalman);
  add_settings(settings, prefix + "adaptive_window.", config.window);
  add_settings(settings, prefix + "robust_exact.", config.robust);
}

}  // namespace teleop
