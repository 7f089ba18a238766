#include "core/tuning/crossing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace teleop {
namespace {

/// 95 % quantile of Student's t, so 90 % two-sided, by degrees of freedom from 1.
double student_t(std::size_t freedom) {
  constexpr std::array<double, 10> kT{6.314, 2.920, 2.353, 2.132, 2.015,
                                      1.943, 1.895, 1.860, 1.833, 1.812};
  if (freedom <= kT.size()) return kT.at(freedom - 1);
  return 1.645 + 1.7 / static_cast<double>(freedom);
}

struct Line {
  double mean_u = 0.0;
  double at_mean = 0.0;  ///< σ there
  double slope = 0.0;
  double var_at_mean = 0.0;
  double var_slope = 0.0;
  double chi2 = 0.0;
};

Line weighted_line(std::span<const GrowthPoint> points, double zero_u, double slope) {
  double sw = 0.0;
  double su = 0.0;
  double ss = 0.0;
  const auto weight = [&](const GrowthPoint& p) {
    const double away = std::log(p.gain) - zero_u;
    const double bend = 0.5 * slope * away * away;
    return 1.0 / (p.std_per_s * p.std_per_s + bend * bend + 1e-12);
  };
  for (const GrowthPoint& p : points) {
    const double w = weight(p);
    sw += w;
    su += w * std::log(p.gain);
    ss += w * p.growth_per_s;
  }
  Line line{.mean_u = su / sw, .at_mean = ss / sw};
  double suu = 0.0;
  double sus = 0.0;
  for (const GrowthPoint& p : points) {
    const double du = std::log(p.gain) - line.mean_u;
    suu += weight(p) * du * du;
    sus += weight(p) * du * (p.growth_per_s - line.at_mean);
  }
  if (suu <= 0.0) return line;
  line.slope = sus / suu;
  line.var_at_mean = 1.0 / sw;
  line.var_slope = 1.0 / suu;
  for (const GrowthPoint& p : points) {
    const double du = std::log(p.gain) - line.mean_u;
    line.chi2 += weight(p) * std::pow(p.growth_per_s - line.at_mean - line.slope * du, 2);
  }
  return line;
}

}  // namespace

std::optional<Crossing> find_crossing(std::span<const GrowthPoint> points) {
  if (points.size() < 3) return std::nullopt;
  const auto nearest = std::min_element(
      points.begin(), points.end(), [](const GrowthPoint& a, const GrowthPoint& b) {
        return std::abs(a.growth_per_s) < std::abs(b.growth_per_s);
      });
  double zero_u = std::log(nearest->gain);
  Line line = weighted_line(points, zero_u, 0.0);
  for (int i = 0; i < 8; ++i) {
    if (line.slope <= 0.0) return std::nullopt;
    // Not further than the points reach: a guess from afar would weigh all of them alike.
    zero_u = std::clamp(line.mean_u - line.at_mean / line.slope, zero_u - 0.5, zero_u + 0.5);
    line = weighted_line(points, zero_u, line.slope);
  }
  if (line.slope <= 0.0) return std::nullopt;
  const std::size_t freedom = points.size() - 2;
  const double chi2 = line.chi2 / static_cast<double>(freedom);
  const double t = student_t(freedom) * std::sqrt(std::max(chi2, 1.0));
  // Fieller: all u at which the line's own deviation reaches zero.
  const double a = line.slope * line.slope - t * t * line.var_slope;
  if (a <= 0.0) return std::nullopt;
  const double b = line.at_mean * line.slope;
  const double c = line.at_mean * line.at_mean - t * t * line.var_at_mean;
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  return Crossing{.gain = std::exp(line.mean_u - line.at_mean / line.slope),
                  .low = std::exp(line.mean_u + (-b - root) / a),
                  .high = std::exp(line.mean_u + (-b + root) / a),
                  .slope_per_s = line.slope,
                  .chi2 = chi2};
}

}  // namespace teleop
