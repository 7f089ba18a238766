#include "core/estimation/velocity_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/base/contract.hpp"
#include "core/estimation/sine_encoder.hpp"

namespace teleop {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Longer than any average, cutoff or bandwidth that is of use needs to settle, and to forget.
constexpr double kMemory_s = 10.0;
constexpr double kMemory_samples = 1.1 * MeanVelocity::kMostSamples;
constexpr int kMiddles = 4;

VelocityEstimator make(const EvenVelocity& estimator) {
  return {estimator.config, JointVector::Constant(estimator.counts_per_rev)};
}

}  // namespace

bool is_linear(const VelocityEstimator::Config& config) noexcept {
  return config.kind == "difference" || config.kind == "mean" || config.kind == "kalman";
}

std::vector<double> impulse_response(const EvenVelocity& estimator) {
  expects(is_linear(estimator.config), "an impulse response is of a linear estimator");
  VelocityEstimator probed = make(estimator);
  const double memory = std::max(kMemory_s / estimator.period_s, kMemory_samples);
  const auto samples = static_cast<std::size_t>(memory);
  std::vector<double> h(samples);
  double most = 0.0;
  for (std::size_t k = 0; k < 2 * samples; ++k) {
    const JointVector q = JointVector::Constant(k == samples ? 1.0 : 0.0);
    const double estimate = probed.step({.q = q, .dt = estimator.period_s})[0];
    if (k >= samples) h[k - samples] = estimate;
    most = std::max(most, std::abs(estimate));
  }
  while (h.size() > 1 && std::abs(h.back()) < 1e-14 * most) {
    h.pop_back();
  }
  return h;
}

std::complex<double> response(std::span<const double> impulse_response,
                              double period_s,
                              double omega_rad_per_s) noexcept {
  const std::complex<double> delay = std::polar(1.0, -omega_rad_per_s * period_s);
  std::complex<double> sum = 0.0;
  for (std::size_t k = impulse_response.size(); k-- > 0;) {
    sum = sum * delay + impulse_response[k];
  }
  return sum;
}

double lag_s(std::span<const double> impulse_response, double period_s) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < impulse_response.size(); ++k) {
    const auto back = static_cast<double>(k);
    sum += 0.5 * back * back * impulse_response[k];
  }
  return -sum * period_s * period_s;
}

double noise_gain(std::span<const double> impulse_response) noexcept {
  double sum = 0.0;
  for (const double h : impulse_response) {
    sum += h * h;
  }
  return std::sqrt(sum);
}

std::complex<double> describing_function(const EvenVelocity& estimator,
                                         double amplitude_rad,
                                         double omega_rad_per_s) {
  const double quantum = kTwoPi / estimator.counts_per_rev;
  const double dt = estimator.period_s;
  const double cycle_s = kTwoPi / omega_rad_per_s;
  const auto settle = static_cast<int>(std::max(0.3, 2.0 * cycle_s) / dt);
  const auto measured = static_cast<int>(std::max(0.4, 5.0 * cycle_s) / dt);
  // Least squares of sine, cosine and mean: cycles need not be whole numbers of samples.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d projected = Eigen::Vector3d::Zero();
  for (int middle = 0; middle < kMiddles; ++middle) {
    const SineEncoder encoder{{.amplitude_counts = amplitude_rad / quantum,
                               .offset_counts = (middle + 0.5) / kMiddles,
                               .omega_rad_per_s = omega_rad_per_s}};
    VelocityEstimator probed = make(estimator);
    for (int k = 0; k < settle + measured; ++k) {
      const SineEncoder::Reading reading = encoder.read(k * dt);
      const std::int32_t ticks = reading.period_ticks;
      const double estimate = probed.step({.q = JointVector::Constant(reading.counts * quantum),
                                           .period_ticks = {ticks, ticks, ticks},
                                           .dt = dt})[0];
      if (k < settle) continue;
      const double phase = omega_rad_per_s * k * dt;
      const Eigen::Vector3d basis{std::sin(phase), std::cos(phase), 1.0};
      normal += basis * basis.transpose();
      projected += basis * estimate;
    }
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(projected);
  return std::complex<double>{fit[0], fit[1]} / amplitude_rad;
}

}  // namespace teleop
