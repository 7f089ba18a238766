#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace teleop {

/// Seeded random numbers that are the same on every machine and with every standard library:
/// splitmix64 [Steele, Lea, Flood 2014] for bits, Box–Muller for the normal distribution.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) noexcept : state_{seed} {}

  [[nodiscard]] constexpr std::uint64_t bits() noexcept {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  /// Uniform in [0, 1).
  [[nodiscard]] constexpr double uniform() noexcept {
    return static_cast<double>(bits() >> 11U) * 0x1.0p-53;
  }

  [[nodiscard]] constexpr double uniform(double low, double high) noexcept {
    return low + (high - low) * uniform();
  }

  /// Zero mean, unit variance.
  [[nodiscard]] double normal() noexcept {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace teleop
