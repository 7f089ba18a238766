#include "core/estimation/smoother.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

constexpr double kReach = 4.0;  // in σ
// ωσ at 1/√2: of (1 + s) e^{−s} and of e^{−s}, s = (ωσ)²/2.
constexpr double kSlopeCorner = 1.4676;
constexpr double kMeanCorner = 0.8326;

double width(double corner, double bandwidth_Hz) noexcept {
  return corner / (2.0 * std::numbers::pi * bandwidth_Hz);
}

/// Calls fit(k, first, end) for every sample with the range that lies within its reach.
template <class Fit>
void for_each_window(std::span<const double> times_s, double reach_s, Fit&& fit) {
  std::size_t first = 0;
  std::size_t end = 0;
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    while (times_s[k] - times_s[first] > reach_s) {
      ++first;
    }
    while (end < times_s.size() && times_s[end] - times_s[k] <= reach_s) {
      ++end;
    }
    fit(k, first, end);
  }
}

}  // namespace

std::vector<JointVector> zero_phase_velocity(std::span<const double> times_s,
                                             std::span<const JointVector> values,
                                             double bandwidth_Hz) {
  expects(times_s.size() == values.size() && bandwidth_Hz > 0.0, "a record and a bandwidth");
  const double sigma = width(kSlopeCorner, bandwidth_Hz);
  std::vector<JointVector> slopes(values.size(), JointVector::Zero());
  for_each_window(times_s, kReach * sigma, [&](std::size_t k, std::size_t first, std::size_t end) {
    if (end - first < 4) return;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
    for (std::size_t i = first; i < end; ++i) {
      const double u = (times_s[i] - times_s[k]) / sigma;
      const double weight = std::exp(-0.5 * u * u);
      const Eigen::Vector4d powers{1.0, u, u * u, u * u * u};
      normal += weight * powers * powers.transpose();
      right += weight * powers * (values[i] - values[k]).transpose();
    }
    slopes[k] = normal.ldlt().solve(right).row(1).transpose() / sigma;
  });
  return slopes;
}

std::vector<JointVector> zero_phase_mean(std::span<const double> times_s,
                                         std::span<const JointVector> values,
                                         double bandwidth_Hz) {
  expects(times_s.size() == values.size() && bandwidth_Hz > 0.0, "a record and a bandwidth");
  const double sigma = width(kMeanCorner, bandwidth_Hz);
  std::vector<JointVector> means(values.size(), JointVector::Zero());
  for_each_window(times_s, kReach * sigma, [&](std::size_t k, std::size_t first, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const double u = (times_s[i] - times_s[k]) / sigma;
      const double weight = std::exp(-0.5 * u * u);
      sum += weight;
      means[k] += weight * values[i];
    }
    means[k] /= sum;
  });
  return means;
}

double zero_phase_margin_s(double bandwidth_Hz) noexcept {
  return kReach * width(kSlopeCorner, bandwidth_Hz);
}

}  // namespace teleop
