#include "core/tuning/crossing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace teleop {
namespace {

constexpr double kFloor = 5e-4;  ///< relative deviation that no number of probes gets below

/// 95 % quantile of Student's t, so 90 % two-sided, by degrees of freedom from 1.
double student_t(double freedom) {
  constexpr std::array<double, 10> kT{6.314, 2.920, 2.353, 2.132, 2.015,
                                      1.943, 1.895, 1.860, 1.833, 1.812};
  if (freedom >= static_cast<double>(kT.size())) return 1.645 + 1.7 / freedom;
  const auto below = static_cast<std::size_t>(freedom);
  const double part = freedom - static_cast<double>(below);
  return (1.0 - part) * kT.at(below - 1) + part * kT.at(below);
}

/// σ = c₀ + c₁ x + c₂ x² + c₃ a, x = u − zero.
struct Parabola {
  Eigen::Vector4d c = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double chi2 = 0.0;
  double freedom = 1.0;  ///< points less what they determine; a prior determines its share
};

Parabola regress(std::span<const GrowthPoint> points, double zero, double slope, double scatter) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  const double prior = 0.5 * std::max(std::abs(slope), 1e-3);
  const double prior_weight = 1.0 / (prior * prior);
  A(2, 2) = prior_weight;
  A(3, 3) = prior_weight;
  const auto weight = [&](const GrowthPoint& p) {
    return 1.0 / (p.std_per_s * p.std_per_s + scatter * scatter + 1e-12);
  };
  const auto row = [&](const GrowthPoint& p) {
    const double x = std::log(p.gain) - zero;
    return Eigen::Vector4d{1.0, x, x * x, p.log_amplitude};
  };
  for (const GrowthPoint& p : points) {
    A += weight(p) * row(p) * row(p).transpose();
    b += weight(p) * p.growth_per_s * row(p);
  }
  Parabola fit;
  const Eigen::Vector4d scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix4d scaled = scale.asDiagonal() * A * scale.asDiagonal();
  fit.covariance = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  fit.c = fit.covariance * b;
  const double from_priors = (fit.covariance(2, 2) + fit.covariance(3, 3)) * prior_weight;
  fit.freedom = std::max(static_cast<double>(points.size()) - 4.0 + from_priors, 1.0);
  for (const GrowthPoint& p : points) {
    fit.chi2 += weight(p) * std::pow(p.growth_per_s - fit.c.dot(row(p)), 2);
  }
  return fit;
}

/// The scatter that explains χ², by bisection; zero where none is needed.
double scatter_of(std::span<const GrowthPoint> points, double zero, double slope) {
  const auto scatters_more = [&](double scatter) {
    const Parabola fit = regress(points, zero, slope, scatter);
    return fit.chi2 > fit.freedom;
  };
  if (!scatters_more(0.0)) return 0.0;
  double low = 0.0;
  double high = 1e-3;
  while (high < 1e6 && scatters_more(high)) {
    high *= 2.0;
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (scatters_more(middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::optional<Crossing> find_crossing(std::span<const GrowthPoint> points) {
  if (points.size() < 3) return std::nullopt;
  const auto [first, last] = std::minmax_element(
      points.begin(), points.end(),
      [](const GrowthPoint& a, const GrowthPoint& b) { return a.gain < b.gain; });
  const double lowest = std::log(first->gain);
  const double highest = std::log(last->gain);
  if (highest - lowest < 1e-9) return std::nullopt;
  double zero = 0.5 * (lowest + highest);
  double slope = 0.0;
  double scatter = 0.0;
  Parabola fit;
  for (int i = 0; i < 12; ++i) {
    fit = regress(points, zero, slope == 0.0 ? 1e9 : slope, scatter);
    if (!(fit.c[1] > 0.0)) return std::nullopt;
    slope = fit.c[1];
    scatter = scatter_of(points, zero, slope);
    // Not far beyond the points.
    zero = std::clamp(zero - fit.c[0] / slope, lowest - 0.1, highest + 0.1);
  }
  fit = regress(points, zero, slope, scatter);
  const double t = student_t(fit.freedom);
  if (fit.c[1] < t * std::sqrt(fit.covariance(1, 1))) return std::nullopt;
  const double deviation = std::hypot(std::sqrt(fit.covariance(0, 0)) / fit.c[1], kFloor);
  const double u = zero - fit.c[0] / fit.c[1];
  return Crossing{.gain = std::exp(u),
                  .low = std::exp(u - t * deviation),
                  .high = std::exp(u + t * deviation),
                  .slope_per_s = fit.c[1],
                  .scatter_per_s = scatter};
}

}  // namespace teleop
