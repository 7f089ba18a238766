#include "core/diagnosis/tether_covariance.hpp"

#include <Eigen/Cholesky>

namespace teleop {
namespace {

constexpr double kStartVariance = 9.0;  // of the speed, rad²/s²

}  // namespace

TetherCovariance::TetherCovariance(const NoiseModel& noise, double period_s)
    : noise_{noise},
      period_s_{period_s},
      memory_{(-period_s * noise.time_constant.cwiseInverse()).array().exp().matrix()} {
  P_.diagonal() << noise.reading.cwiseAbs2(), JointVector::Constant(kStartVariance),
      noise.coloured.cwiseAbs2();
}

JointMatrix TetherCovariance::of_innovation() const {
  JointMatrix S = P_.topLeftCorner<3, 3>();
  S.diagonal() += noise_.reading.cwiseAbs2();
  return S;
}

void TetherCovariance::update() {
  const Eigen::Matrix<double, 9, 3> gain = of_innovation().llt().solve(P_.topRows<3>()).transpose();
  P_ -= (gain * P_.topRows<3>()).eval();
}

void TetherCovariance::pass(const JointMatrix& mobility, const JointMatrix& stiffness) {
  const Matrix F = transition(mobility, stiffness);
  P_ = (F * P_ * F.transpose()).eval();
  Eigen::Matrix<double, 9, 3> push = Eigen::Matrix<double, 9, 3>::Zero();
  push.topRows<3>() = period_s_ * period_s_ / 2.0 * mobility;
  push.middleRows<3>(3) = period_s_ * mobility;
  P_ += push * noise_.white.cwiseAbs2().asDiagonal() * push.transpose();
  P_.diagonal().tail<3>() +=
      noise_.coloured.cwiseAbs2().cwiseProduct(JointVector::Ones() - memory_.cwiseAbs2());
  P_ = (P_ + P_.transpose()).eval() / 2.0;
}

void TetherCovariance::forget_disturbance() {
  // Errors of an estimate do not hang together with the estimate: the rest of P stays.
  P_.bottomRightCorner<3, 3>() = noise_.coloured.cwiseAbs2().asDiagonal();
}

TetherCovariance::Matrix TetherCovariance::transition(const JointMatrix& mobility,
                                                      const JointMatrix& stiffness) const {
  Matrix F = Matrix::Identity();
  F.block<3, 3>(3, 0) = -period_s_ * mobility * stiffness;
  F.block<3, 3>(0, 3).diagonal().setConstant(period_s_);
  F.block<3, 3>(0, 6) = period_s_ * period_s_ / 2.0 * mobility;
  F.block<3, 3>(3, 6) = period_s_ * mobility;
  F.block<3, 3>(6, 6) = memory_.asDiagonal();
  return F;
}

}  // namespace teleop
