#include "core/diagnosis/audit_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>
#include <fmt/format.h>

#include "core/diagnosis/audit_checks.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

constexpr double kHalfWidth_s = 0.02;  ///< of the second differences
constexpr Eigen::Index kNuisances = 13;
constexpr Eigen::Index kFewestSamples = 100;

struct Samples {
  Eigen::MatrixXd command;   ///< weighted by the triangle; an axis a column
  Eigen::MatrixXd inertial;  ///< torque of the nominal model's inertia
  Eigen::MatrixXd nuisance;
};

/// Weight, speed, its sign and position of every axis, and a constant.
Eigen::Matrix<double, 1, kNuisances> nuisances(const ArmModel* arm,
                                               const JointVector& q,
                                               const JointVector& qd) {
  const JointVector weight = arm != nullptr ? gravity_torque(*arm, q) : JointVector{q.array().sin()};
  const JointVector sense = qd.array().sign();
  Eigen::Matrix<double, 1, kNuisances> row;
  row << weight.transpose(), qd.transpose(), sense.transpose(), q.transpose(), 1.0;
  return row;
}

JointVector inertial_torque(const DiagnosisCase& of,
                            const ArmModel* arm,
                            const JointVector& q,
                            const JointVector& qdd) {
  if (arm != nullptr) return mass_matrix(*arm, q) * qdd;
  JointVector torque = qdd;
  for (std::size_t i = 0; i < of.bench.size(); ++i) {
    torque[static_cast<Eigen::Index>(i)] *= of.bench[i].inertia.value_or(1.0);
  }
  return torque;
}

Samples sample(const DiagnosisCase& of, const ArmModel* arm, const Recording& run) {
  const double T = of.period_s;
  const auto h = std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(kHalfWidth_s / T)));
  const std::size_t stride = std::max<std::size_t>(1, h / 4);
  const std::size_t count = run.rows() < 2 * h + 1 ? 0 : (run.rows() - 2 * h - 1) / stride + 1;
  const auto rows = static_cast<Eigen::Index>(count);
  Samples out{.command = Eigen::MatrixXd::Zero(rows, 3),
              .inertial = Eigen::MatrixXd::Zero(rows, 3),
              .nuisance = Eigen::MatrixXd::Zero(rows, kNuisances)};
  const double wide = static_cast<double>(h);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t k = h + n * stride;
    const auto at = static_cast<Eigen::Index>(n);
    JointVector force = JointVector::Zero();
    for (std::size_t j = k - h; j < k + h; ++j) {
      const double weight = wide - std::abs(static_cast<double>(j) - static_cast<double>(k) + 0.5);
      force += weight * run.tau[j];
      if (!run.contact.empty()) force -= weight * run.contact[j];
    }
    const JointVector qdd = (run.q[k + h] - 2.0 * run.q[k] + run.q[k - h]) / (wide * wide * T * T);
    const JointVector qd = (run.q[k + h] - run.q[k - h]) / (2.0 * wide * T);
    out.command.row(at) = force.transpose() / (wide * wide);
    out.inertial.row(at) = inertial_torque(of, arm, run.q[k], qdd).transpose();
    out.nuisance.row(at) = nuisances(arm, run.q[k], qd);
  }
  return out;
}

}  // namespace

std::optional<CommandFit> fit_commands(const DiagnosisCase& of,
                                       const ArmModel* arm,
                                       const Recording& run) {
  const Samples samples = sample(of, arm, run);
  if (samples.command.rows() < kFewestSamples) return std::nullopt;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> nuisance{samples.nuisance};
  const Eigen::MatrixXd u = samples.command - samples.nuisance * nuisance.solve(samples.command);
  const Eigen::MatrixXd w = samples.inertial - samples.nuisance * nuisance.solve(samples.inertial);
  CommandFit fit;
  const auto n = static_cast<double>(u.rows());
  for (Eigen::Index j = 0; j < 3; ++j) {
    const double norm = w.col(j).norm();
    fit.torque[j] = norm / std::sqrt(n);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double both = norm * u.col(i).norm();
      if (!(both > std::numeric_limits<double>::min())) continue;
      fit.correlation(i, j) = u.col(i).dot(w.col(j)) / both;
      fit.share(i, j) = u.col(i).dot(w.col(j)) / (norm * norm);
    }
  }
  return fit;
}

void audit_motion(const AuditNotes& notes) { static_cast<void>(notes); }
void audit_currents(const AuditNotes& notes) { static_cast<void>(notes); }

}  // namespace teleop
