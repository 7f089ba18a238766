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
constexpr Eigen::Index kNuisances = 16;
constexpr Eigen::Index kFewestSamples = 100;

struct Samples {
  Eigen::MatrixXd command;   ///< weighted by the triangle; an axis a column
  Eigen::MatrixXd inertial;  ///< torque of the nominal model's inertia
  Eigen::MatrixXd nuisance;
};

/// Weight, speed, its sign and position of every axis, contact whose gain may be off, a constant.
Eigen::Matrix<double, 1, kNuisances> nuisances(const ArmModel* arm,
                                               const JointVector& q,
                                               const JointVector& qd,
                                               const JointVector& contact) {
  const JointVector weight =
      arm != nullptr ? gravity_torque(*arm, q) : JointVector{q.array().sin()};
  const JointVector sense = qd.array().sign();
  Eigen::Matrix<double, 1, kNuisances> row;
  row << weight.transpose(), qd.transpose(), sense.transpose(), q.transpose(), contact.transpose(),
      1.0;
  return row;
}

/// The mean of a held signal over the 2h intervals about row k, weighted by the triangle that makes
/// it the counterpart of a second difference.
JointVector triangle_mean(const std::vector<JointVector>& rows, std::size_t k, std::size_t h) {
  JointVector sum = JointVector::Zero();
  if (rows.empty()) return sum;
  const double wide = static_cast<double>(h);
  for (std::size_t j = k - h; j < k + h; ++j) {
    sum += (wide - std::abs(static_cast<double>(j) - static_cast<double>(k) + 0.5)) * rows[j];
  }
  return sum / (wide * wide);
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

/// Of each axis: 1 where its measured contact may be believed, 0 where its gain may be off.
JointVector believed_contact(const DiagnosisCase& of) {
  JointVector believed = JointVector::Ones();
  for (std::size_t i = 0; i < of.bench.size(); ++i) {
    if (of.bench[i].contact_tolerance > 0.0) believed[static_cast<Eigen::Index>(i)] = 0.0;
  }
  return believed;
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
  const JointVector believed = believed_contact(of);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t k = h + n * stride;
    const auto at = static_cast<Eigen::Index>(n);
    const JointVector qdd = (run.q[k + h] - 2.0 * run.q[k] + run.q[k - h]) / (wide * wide * T * T);
    const JointVector qd = (run.q[k + h] - run.q[k - h]) / (2.0 * wide * T);
    const JointVector contact = triangle_mean(run.contact, k, h);
    const JointVector known = believed.cwiseProduct(contact);
    out.command.row(at) = (triangle_mean(run.tau, k, h) - known).transpose();
    out.inertial.row(at) = inertial_torque(of, arm, run.q[k], qdd).transpose();
    out.nuisance.row(at) = nuisances(arm, run.q[k], qd, contact - known);
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

namespace {

constexpr double kClear = 0.8;        ///< correlation that cannot be chance
constexpr double kMuchBetter = 0.25;  ///< share of the unexplained that is left
/// Factor between command and inertial torque: a heavy hand makes 12, degrees make 57.
constexpr double kWrongUnits = 25.0;

double unexplained(double correlation) { return 1.0 - correlation * correlation; }

/// The other command that explains the motion of `axis`, and clearly better than its own does and
/// than it explains that of its own axis.
std::optional<std::size_t> other_command(const CommandFit& fit,
                                         std::size_t axis,
                                         std::size_t axes) {
  const auto j = static_cast<Eigen::Index>(axis);
  for (std::size_t other = 0; other < axes; ++other) {
    const auto i = static_cast<Eigen::Index>(other);
    if (other == axis || fit.correlation(i, j) < kClear) continue;
    const double left = unexplained(fit.correlation(i, j));
    const bool better = left < kMuchBetter * unexplained(fit.correlation(j, j)) &&
                        left < kMuchBetter * unexplained(fit.correlation(i, i));
    if (better) return other;
  }
  return std::nullopt;
}

void find_sign(const AuditNotes& notes, const CommandFit& fit, std::size_t axis) {
  const auto i = static_cast<Eigen::Index>(axis);
  const double correlation = fit.correlation(i, i);
  if (correlation > -kClear) return;
  notes.add(
      Severity::fatal, "wrong_sign", command_column(notes.of(), axis), 0,
      fmt::format("pushes against the acceleration of {} (correlation {:.2f}): one of the two "
                  "has the wrong sign",
                  position_column(notes.of(), axis), correlation));
}

void find_units(const AuditNotes& notes, const CommandFit& fit, std::size_t axis) {
  const auto i = static_cast<Eigen::Index>(axis);
  const bool arm = notes.arm() != nullptr;
  const double factor = fit.share(i, i);
  const bool known = arm || notes.of().bench[axis].inertia;
  const bool wrong = factor > kWrongUnits || factor < 1.0 / kWrongUnits;
  if (!known || fit.correlation(i, i) < kClear || !wrong) return;
  notes.add(arm ? Severity::fatal : Severity::warning, "wrong_units",
            command_column(notes.of(), axis), 0,
            fmt::format("is {:.3g} times the torque that the acceleration of {} takes: check the "
                        "units of both (N m not N mm, rad not degrees)",
                        factor, position_column(notes.of(), axis)));
}

/// Rows between a signal and another that follows it most closely; nothing when none is clear.
std::optional<int> lag_of(const std::vector<double>& leader, const std::vector<double>& follower) {
  constexpr int kMost = 5;
  double best = std::numeric_limits<double>::infinity();
  double others = best;
  int lag = 0;
  for (int shift = -kMost; shift <= kMost; ++shift) {
    double squares = 0.0;
    for (std::size_t k = kMost; k + kMost < leader.size(); ++k) {
      const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + shift);
      squares += (follower[at] - leader[k]) * (follower[at] - leader[k]);
    }
    if (squares < best) {
      others = best;
      best = squares;
      lag = shift;
    } else {
      others = std::min(others, squares);
    }
  }
  if (!(best < 0.5 * others)) return std::nullopt;
  return lag;
}

}  // namespace

void audit_motion(const AuditNotes& notes) {
  const auto fit = fit_commands(notes.of(), notes.arm(), notes.run());
  if (!fit) return;
  const std::size_t axes = notes.of().axes();
  for (std::size_t axis = 0; axis < axes; ++axis) {
    if (const auto other = other_command(*fit, axis, axes)) {
      notes.add(
          notes.arm() != nullptr ? Severity::fatal : Severity::warning, "swapped_columns",
          command_column(notes.of(), *other), 0,
          fmt::format("explains the acceleration of {}, and {} does not: are columns swapped?",
                      position_column(notes.of(), axis), command_column(notes.of(), axis)));
      continue;
    }
    find_sign(notes, *fit, axis);
    find_units(notes, *fit, axis);
  }
}

void audit_currents(const AuditNotes& notes) {
  const Recording& run = notes.run();
  for (std::size_t axis = 0; axis < notes.of().axes() && !run.measured.empty(); ++axis) {
    const auto lag = lag_of(axis_of(run.tau, axis), axis_of(run.measured, axis));
    if (!lag || *lag >= 0) continue;
    notes.add(
        Severity::fatal, "swapped_currents", command_column(notes.of(), axis), 0,
        fmt::format("follows the measured current by {} row(s) instead of leading it: command "
                    "and measurement are swapped",
                    -*lag));
  }
}

}  // namespace teleop
