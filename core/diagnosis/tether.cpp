#include "core/diagnosis/tether.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

constexpr double kStartSpeed = 3.0;  // rad/s, standard deviation of what is not known

/// Covariance of (q, v, d); every block a 3 × 3 matrix.
struct Covariance {
  JointMatrix qq = JointMatrix::Zero();
  JointMatrix qv = JointMatrix::Zero();
  JointMatrix qd = JointMatrix::Zero();
  JointMatrix vv = JointMatrix::Zero();
  JointMatrix vd = JointMatrix::Zero();
  JointMatrix dd = JointMatrix::Zero();
};

/// Takes the reading in and gives its gains.
Tether::Step update(Covariance& P, const JointVector& reading_variance) {
  JointMatrix S = P.qq;
  S.diagonal() += reading_variance;
  const Eigen::LLT<JointMatrix> factor{S};
  const JointMatrix L = factor.matrixL();
  Tether::Step step;
  step.whitening = L.triangularView<Eigen::Lower>().solve(JointMatrix::Identity());
  step.log_determinant = 2.0 * (std::log(L(0, 0)) + std::log(L(1, 1)) + std::log(L(2, 2)));
  const JointMatrix inverse = step.whitening.transpose() * step.whitening;
  step.position = P.qq * inverse;
  step.velocity = P.qv.transpose() * inverse;
  step.disturbance = P.qd.transpose() * inverse;
  P.vv -= step.velocity * P.qv;
  P.vd -= step.velocity * P.qd;
  P.dd -= step.disturbance * P.qd;
  const JointMatrix left = JointMatrix::Identity() - step.position;
  P.qv = left * P.qv;
  P.qd = left * P.qd;
  P.qq = left * P.qq;
  P.qq = (P.qq + P.qq.transpose()).eval() / 2.0;
  return step;
}

/// What a sample adds to what is not known.
struct Growth {
  double h = 0.0;                              ///< s
  JointVector white = JointVector::Zero();     ///< variance, N² m²
  JointVector coloured = JointVector::Zero();  ///< variance of its fresh part, N² m²
  JointVector memory = JointVector::Zero();    ///< φ
};

/// Lets a sample pass.
void predict(Covariance& P, const JointMatrix& W, const Growth& growth) {
  const double h = growth.h;
  const JointVector& memory = growth.memory;
  const JointMatrix jump = h * W;
  const JointMatrix reach = h / 2.0 * jump;
  // Rows, then columns, of F P Fᵀ.
  const JointMatrix vd = P.vd + jump * P.dd;
  const JointMatrix qd = P.qd + h * P.vd + reach * P.dd;
  const JointMatrix vv = P.vv + jump * P.vd.transpose();
  const JointMatrix qv = P.qv + h * P.vv + reach * P.vd.transpose();
  const JointMatrix qq = P.qq + h * P.qv.transpose() + reach * P.qd.transpose();
  P.qq = qq + h * qv + qd * reach.transpose();
  P.qv = qv + qd * jump.transpose();
  P.qd = qd * memory.asDiagonal();
  P.vv = vv + vd * jump.transpose();
  P.vd = vd * memory.asDiagonal();
  P.dd = memory.asDiagonal() * P.dd * memory.asDiagonal();
  const JointMatrix noisy_jump = jump * growth.white.asDiagonal();
  P.vv += noisy_jump * jump.transpose();
  P.qv += h / 2.0 * noisy_jump * jump.transpose();
  P.qq += h * h / 4.0 * noisy_jump * jump.transpose();
  P.dd.diagonal() += growth.coloured;
}

}  // namespace

std::vector<JointMatrix> mobilities(const ArmModel& arm, const Recording& run) {
  std::vector<JointMatrix> all;
  all.reserve(run.rows());
  for (const JointVector& q : run.q) {
    all.emplace_back(mass_matrix(arm, q).inverse());
  }
  return all;
}

Tether::Tether(const ArmModel& arm,
               const Recording& run,
               double period_s,
               const NoiseModel& noise,
               std::size_t rows)
    : noise_{noise},
      memory_{(-period_s * noise.time_constant.cwiseInverse()).array().exp().matrix()} {
  const JointVector reading = noise.reading.cwiseAbs2();
  const JointVector coloured = noise.coloured.cwiseAbs2();
  const Growth growth{.h = period_s,
                      .white = noise.white.cwiseAbs2(),
                      .coloured = coloured.cwiseProduct(JointVector::Ones() - memory_.cwiseAbs2()),
                      .memory = memory_};
  Covariance P;
  P.qq = reading.asDiagonal();
  P.vv = JointMatrix::Identity() * kStartSpeed * kStartSpeed;
  P.dd = coloured.asDiagonal();
  const std::size_t count = rows == 0 ? run.rows() : std::min(rows, run.rows());
  steps_.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    steps_.push_back(update(P, reading));
    predict(P, mass_matrix(arm, run.q[k]).inverse(), growth);
  }
}

}  // namespace teleop
