#include "core/estimation/damping_limit.hpp"

#include <cmath>
#include <numbers>

namespace teleop {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kBisections = 26;

}  // namespace

std::complex<double> SampledMass::response(double omega_rad_per_s) const noexcept {
  const double T = period_s;
  const double h = damping_Ns_per_m * T / mass_kg;
  // g1 = (1 − e^{−h})/h and g2 = (1 − g1)/h, by their series where the quotients lose digits.
  const bool small = h < 1e-4;
  const double g1 = small ? 1.0 - h / 2.0 + h * h / 6.0 : -std::expm1(-h) / h;
  const double g2 = small ? 0.5 - h / 6.0 + h * h / 24.0 : (1.0 - g1) / h;
  const double decay = std::exp(-h);
  const std::complex<double> z = std::polar(1.0, omega_rad_per_s * T);
  return T * T / mass_kg * (g2 * (z - decay) + g1 * g1) / ((z - 1.0) * (z - decay));
}

std::optional<DampingLimit> damping_limit(const SampledMass& mass,
                                          const std::function<std::complex<double>(double)>& H,
                                          const FrequencyGrid& grid) {
  const auto loop = [&](double omega) {
    return H(omega) * mass.response(omega);
  };
  std::optional<DampingLimit> least;
  const auto try_at = [&](double omega, double real_part) {
    if (real_part >= 0.0) return;
    const double damping = -1.0 / real_part;
    if (least && least->damping_Ns_per_m <= damping) return;
    least = {.damping_Ns_per_m = damping, .frequency_Hz = omega / kTwoPi};
  };
  const double step = std::pow(grid.highest_Hz / grid.lowest_Hz, 1.0 / grid.points);
  double before = kTwoPi * grid.lowest_Hz;
  std::complex<double> at_before = loop(before);
  for (int i = 1; i <= grid.points; ++i) {
    const double omega = kTwoPi * grid.lowest_Hz * std::pow(step, i);
    const std::complex<double> value = loop(omega);
    if (at_before.imag() * value.imag() < 0.0 && (at_before.real() < 0.0 || value.real() < 0.0)) {
      double low = before;
      double high = omega;
      for (int k = 0; k < kBisections; ++k) {
        const double middle = 0.5 * (low + high);
        (loop(middle).imag() * at_before.imag() > 0.0 ? low : high) = middle;
      }
      try_at(low, loop(low).real());
    }
    before = omega;
    at_before = value;
  }
  // At half the rate of the loop e^{jωT} = −1 and everything is real.
  const double half_rate = std::numbers::pi / mass.period_s;
  if (std::abs(before - half_rate) < 1e-6 * half_rate) try_at(half_rate, at_before.real());
  return least;
}

}  // namespace teleop
