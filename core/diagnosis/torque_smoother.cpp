#include "core/diagnosis/torque_smoother.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace teleop {
namespace {

constexpr double kMemory_s = 0.5;      // of the disturbance that may wander
constexpr double kLeastTorque = 3e-4;  // N m, standard deviation of it

/// The same roughness, a longer memory.
NoiseModel wandering(const NoiseModel& noise) {
  NoiseModel wide = noise;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double stretch = std::sqrt(std::max(1.0, kMemory_s / noise.time_constant[i]));
    wide.coloured[i] = stretch * std::max(noise.coloured[i], kLeastTorque);
    wide.time_constant[i] = std::max(noise.time_constant[i], kMemory_s);
  }
  return wide;
}

}  // namespace

TorqueSmoother::TorqueSmoother(const ArmModel& arm,
                               const Recording& run,
                               double period_s,
                               const NoiseModel& noise)
    : run_{run},
      period_s_{period_s},
      tether_{arm, run, period_s, wandering(noise)},
      covariance_{tether_.noise(), period_s},
      mobility_{mobilities(arm, run)} {
  before_.reserve(run.rows());
  for (std::size_t k = 0; k < run.rows(); ++k) {
    before_.push_back(covariance_.matrix());
    covariance_.update();
    covariance_.pass(mobility_[k]);
  }
}

std::vector<TorqueSmoother::Row> TorqueSmoother::smooth(const PredictorModel& model) const {
  std::vector<PredictedState> states;
  const Prediction told = predict(model, run_, period_s_, tether_, &states);
  if (states.size() < run_.rows()) return {};
  const JointVector reading = tether_.noise().reading.cwiseAbs2();
  std::vector<Row> rows(run_.rows());
  Eigen::Matrix<double, 9, 1> adjoint = Eigen::Matrix<double, 9, 1>::Zero();
  for (std::size_t k = run_.rows(); k-- > 0;) {
    const TetherCovariance::Matrix& P = before_[k];
    JointMatrix S = P.topLeftCorner<3, 3>();
    S.diagonal() += reading;
    const JointVector pull = told.innovations[k] + P.topRows<3>() * adjoint;
    adjoint.head<3>() -= S.llt().solve(pull);
    rows[k] = {.q = states[k].q,
               .qd = states[k].qd,
               .torque = states[k].disturbance - P.bottomRows<3>() * adjoint};
    if (k > 0) adjoint = covariance_.transition(mobility_[k - 1]).transpose() * adjoint;
  }
  return rows;
}

}  // namespace teleop
