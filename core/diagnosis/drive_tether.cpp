#include "core/diagnosis/drive_tether.hpp"

#include <cmath>

#include <Eigen/Core>

#include "core/math/matrix_exponential.hpp"

namespace teleop {
namespace {

template <int N>
using Matrix = Eigen::Matrix<double, N, N>;
template <int N>
using Vector = Eigen::Matrix<double, N, 1>;

/// ẋ = A x + b (w + d), held torques, d⁺ = φ d + noise: the gain by (x, d) at which the filter
/// that reads the first state comes to rest.
template <int N>
struct Steady {
  Vector<N + 1> gain = Vector<N + 1>::Zero();
  double deviation = 0.0;  ///< of the innovations
};

template <int N>
Steady<N> steady_gain(const Matrix<N>& A,
                      const Vector<N>& b,
                      double period_s,
                      const AxisNoise& noise) {
  constexpr int kSteps = 3000;  // samples: three seconds
  Matrix<N + 1> both = Matrix<N + 1>::Zero();
  both.template topLeftCorner<N, N>() = A * period_s;
  both.template topRightCorner<N, 1>() = b * period_s;
  const Matrix<N + 1> passed = matrix_exponential(both);
  Matrix<N + 1> F = passed;
  F(N, N) = noise.memory;
  const Vector<N> jump = passed.template topRightCorner<N, 1>();
  Matrix<N + 1> Q = Matrix<N + 1>::Zero();
  Q.template topLeftCorner<N, N>() = jump * jump.transpose() * noise.white * noise.white;
  Q(N, N) = noise.coloured * noise.coloured * (1.0 - noise.memory * noise.memory);
  const double reading_variance = noise.reading * noise.reading;
  Matrix<N + 1> P = Q * 100.0;
  P(0, 0) += reading_variance;
  Steady<N> result;
  for (int k = 0; k < kSteps; ++k) {
    const Vector<N + 1> next = P.col(0) / (P(0, 0) + reading_variance);
    const bool rests = (next - result.gain).norm() < 1e-9 * next.norm();
    result = {.gain = next, .deviation = std::sqrt(P(0, 0) + reading_variance)};
    if (rests) break;
    const Matrix<N + 1> updated = P - next * P.row(0);
    const Matrix<N + 1> moved = F * updated;
    P = moved * F.transpose() + Q;
    P = (P + P.transpose()).eval() / 2.0;
  }
  return result;
}

}  // namespace

DriveGains elastic_gains(const Transmission& transmission,
                         double link_inertia,
                         double period_s,
                         const AxisNoise& noise) {
  const double k = transmission.stiffness;
  const double c = transmission.damping;
  const double J = transmission.drive_inertia;
  const double I = link_inertia;
  Matrix<4> A = Matrix<4>::Zero();  // m, ṁ, q, q̇
  A(0, 1) = 1.0;
  A.row(1) << -k / J, -c / J, k / J, c / J;
  A(2, 3) = 1.0;
  A.row(3) << k / I, c / I, -k / I, -c / I;
  const Vector<4> b{0.0, 1.0 / J, 0.0, 0.0};
  const auto [gain, deviation] = steady_gain<4>(A, b, period_s, noise);
  return {.m = gain[0],
          .md = gain[1],
          .q = gain[2],
          .qd = gain[3],
          .d = gain[4],
          .deviation = deviation};
}

DriveGains free_gains(const Transmission& transmission, double period_s, const AxisNoise& noise) {
  Matrix<2> A = Matrix<2>::Zero();
  A(0, 1) = 1.0;
  const Vector<2> b{0.0, 1.0 / transmission.drive_inertia};
  const auto [gain, deviation] = steady_gain<2>(A, b, period_s, noise);
  return {.m = gain[0], .md = gain[1], .d = gain[2], .deviation = deviation};
}

}  // namespace teleop
