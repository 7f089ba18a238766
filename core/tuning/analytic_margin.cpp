#include "core/tuning/analytic_margin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Dense>

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr int kFrequencies = 8000;

/// Gains, complex in general, that put a pole at e^{jωT}. Without a delayed peer there is one.
std::array<Complex, 2> gains_at(const SampledLoop& loop, TunedGain tuned, double omega) {
  const Complex P1 = arm_response(loop.arms[0], loop.period_s, omega);
  std::array<Complex, 2> c{-1.0 / P1, -1.0 / P1};
  if (loop.arms.size() == 2) {
    const Complex P2 = arm_response(loop.arms[1], loop.period_s, omega);
    const int p = loop.peer_delay_samples;
    c.fill(-1.0 / (P1 + P2));
    if (p > 0) {
      const Complex round = std::polar(1.0, -2.0 * p * omega * loop.period_s);
      const Complex a = P1 * P2 * (1.0 - round);
      const Complex root = std::sqrt((P1 + P2) * (P1 + P2) - 4.0 * a);
      // The form without cancellation; both roots matter.
      const Complex plus = P1 + P2 + root;
      const Complex minus = P1 + P2 - root;
      c = {-2.0 / plus, -2.0 / minus};
    }
  }
  const Complex D = estimator_response(loop, omega);
  std::array<Complex, 2> gains{};
  std::transform(c.begin(), c.end(), gains.begin(), [&](const Complex& law) {
    return tuned == TunedGain::stiffness ? law - loop.damping_Ns_per_m * D
                                         : (law - loop.stiffness_N_per_m) / D;
  });
  return gains;
}

/// Swaps the two where that continues the last pair better.
std::array<Complex, 2> in_order(const std::array<Complex, 2>& next,
                                const std::array<Complex, 2>& last) {
  const double straight = std::abs(next[0] - last[0]) + std::abs(next[1] - last[1]);
  const double crossed = std::abs(next[0] - last[1]) + std::abs(next[1] - last[0]);
  if (crossed < straight) return {next[1], next[0]};
  return next;
}

SampledLoop with_gain(SampledLoop loop, TunedGain tuned, double gain) {
  (tuned == TunedGain::stiffness ? loop.stiffness_N_per_m : loop.damping_Ns_per_m) = gain;
  return loop;
}

/// Frequency of the least stable pole that oscillates.
double frequency_of(const SampledLoop& loop) {
  const Eigen::VectorXcd roots = transition(loop).eigenvalues();
  Complex least{0.0, 0.0};
  for (const Complex& root : roots) {
    const bool drifts = std::abs(root - 1.0) < 1e-7;
    if (!drifts && std::abs(root) > std::abs(least)) least = root;
  }
  return std::abs(std::arg(least)) / (2.0 * std::numbers::pi * loop.period_s);
}

}  // namespace

std::optional<AnalyticMargin> nyquist_margin(const SampledLoop& loop, TunedGain tuned) {
  const double highest = std::numbers::pi / loop.period_s;
  std::optional<AnalyticMargin> best;
  const auto offer = [&](const Complex& gain, double omega) {
    const bool passes = gain.real() > 0.0 && (!best || gain.real() < best->gain);
    if (passes) best = {.gain = gain.real(), .frequency_Hz = omega / (2.0 * std::numbers::pi)};
  };
  double omega = highest * 1e-3 / kFrequencies;
  std::array<Complex, 2> last = gains_at(loop, tuned, omega);
  for (int k = 1; k <= kFrequencies; ++k) {
    // Dense at low frequencies, where slow loops have their margins; a phase of its own so that
    // no step ends where an estimator over many samples is blind.
    const double share = (k - 0.37) / kFrequencies;
    const double next_omega = k == kFrequencies ? highest : highest * share * (0.1 + 0.9 * share);
    const std::array<Complex, 2> next = in_order(gains_at(loop, tuned, next_omega), last);
    for (std::size_t branch = 0; branch < 2; ++branch) {
      if ((last.at(branch).imag() < 0.0) == (next.at(branch).imag() < 0.0)) continue;
      double low = omega;
      double high = next_omega;
      std::array<Complex, 2> at_low = last;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        const std::array<Complex, 2> at = in_order(gains_at(loop, tuned, middle), at_low);
        const bool below = (at.at(branch).imag() < 0.0) == (at_low.at(branch).imag() < 0.0);
        (below ? low : high) = middle;
        if (below) at_low = at;
      }
      // A pole of the gain changes its sign too, through infinity.
      const bool crosses = std::abs(at_low.at(branch).imag()) < 1e-5 * std::abs(at_low.at(branch));
      if (crosses) offer(at_low.at(branch), low);
    }
    omega = next_omega;
    last = next;
  }
  for (const Complex& gain : last) {
    if (std::abs(gain.imag()) < 1e-9 * std::abs(gain)) offer(gain, highest);
  }
  return best;
}

std::optional<AnalyticMargin> eigenvalue_margin(const SampledLoop& loop,
                                                TunedGain tuned,
                                                double from,
                                                double to) {
  const auto stable = [&](double gain) {
    return spectral_radius(with_gain(loop, tuned, gain)) < 1.0;
  };
  if (!stable(from)) return AnalyticMargin{};
  double low = from;
  double high = 1.05 * from;
  while (stable(high)) {
    if (high > to) return std::nullopt;
    low = high;
    high *= 1.05;
  }
  while (high - low > 1e-7 * low) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return AnalyticMargin{.gain = high, .frequency_Hz = frequency_of(with_gain(loop, tuned, high))};
}

}  // namespace teleop
