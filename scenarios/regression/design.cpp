#include "scenarios/regression/design.hpp"

#include <algorithm>

#include "core/base/contract.hpp"
#include "core/diagnosis/base_prior.hpp"
#include "scenarios/regression/columns.hpp"

namespace teleop {
namespace {

constexpr std::size_t kEvery = 10;     // samples, one of which is kept
constexpr std::size_t kEnds = 250;     // samples that the filter spoils
constexpr double kTolerance = 0.0029;  // standard deviation of masses and inertias, as a share

Regressor::Use use_of(const ArmModel& arm, const std::vector<SmoothRun>& runs, std::size_t axis) {
  Regressor::Use use{.ratio = arm.parameters().transmission_ratio.at(axis)};
  for (const SmoothRun& run : runs) {
    for (const double u : axis_of(run.command, axis)) {
      use.torque_peak = std::max(use.torque_peak, std::abs(u));
    }
    const std::vector<double> angles = axis_of(run.q, axis);
    use.angles.insert(use.angles.end(), angles.begin(), angles.end());
  }
  std::sort(use.angles.begin(), use.angles.end());
  return use;
}

Signal difference(const Signal& a, const Signal& b) {
  Signal result = a;
  for (std::size_t k = 0; k < a.size(); ++k) {
    result[k] -= b[k];
  }
  return result;
}

}  // namespace

Eigen::Index Design::base_columns() noexcept { return BasePrior::kSize; }

Design::Design(const DiagnosisCase& data, const ArmModel& arm)
    : arm_{arm}, filter_{kCutoff_Hz, data.period_s} {
  expects(data.bench.empty() && data.runs.size() > 1, "an arm with runs to leave out");
  lay_out(data);
  add_forms();
  const Eigen::Index base = base_columns();
  const Eigen::Index last = forms_.empty() ? base : forms_.back().first + forms_.back().count;
  columns_ = Eigen::MatrixXd::Zero(rows_ * static_cast<Eigen::Index>(kJoints), last + 1);
  const BasePrior prior{arm_, kTolerance};
  const ZeroPhaseFilter smoother{kSmooth_Hz, data.period_s};  // as the readings were
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const Signal nominal = inverse_dynamics(arm_, runs_[run]);
    std::vector<Signal> rigid;
    rigid.reserve(static_cast<std::size_t>(base));
    for (Eigen::Index i = 0; i < base; ++i) {
      rigid.push_back(
          difference(nominal, inverse_dynamics(prior.arm(BasePrior::Vector::Unit(i)), runs_[run])));
    }
    put(rigid, run, columns_.leftCols(base));
    put({difference(nominal, smoother(runs_[run].command))}, run, columns_.rightCols(1));
  }
  for (const Form& form : forms_) {
    columns_.middleCols(form.first, form.count) = columns(*form.regressor, form.axis, form.shape);
  }
  multiply();
}

void Design::lay_out(const DiagnosisCase& data) {
  std::vector<Eigen::Index> counts;
  counts.reserve(data.runs.size());
  runs_.reserve(data.runs.size());
  for (const Recording& run : data.runs) {
    expects(run.rows() > 2 * kEnds + kEvery, "a run is longer than what the filter spoils");
    runs_.push_back(smooth(run, data.period_s, {kSmooth_Hz, data.period_s}));
    counts.push_back(static_cast<Eigen::Index>((run.rows() - 2 * kEnds) / kEvery));
    rows_ += counts.back();
  }
  held_out_ = counts.back();
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    Eigen::Index first = rows_ * static_cast<Eigen::Index>(axis);
    for (const Eigen::Index count : counts) {
      stretches_.push_back({.axis = axis, .first = first, .count = count});
      first += count;
    }
  }
  find_motion();
}

void Design::find_motion() {
  moves_.reserve(static_cast<std::size_t>(rows_) * kJoints);
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    const Stretch& stretch = stretches_[i];
    const std::size_t run = i % runs_.size();
    const Rows part = run + 1 < runs_.size() ? Rows::training : Rows::held_out;
    for (std::size_t k = 0; k < static_cast<std::size_t>(stretch.count); ++k) {
      const JointVector& qd = runs_[run].qd[kEnds + kEvery * k];
      moves_.push_back(std::abs(qd[static_cast<Eigen::Index>(stretch.axis)]) > kStill_rad_per_s);
      if (!moves_.back()) continue;
      sizes_.at(static_cast<std::size_t>(part)).at(stretch.axis) += 1.0;
      sizes_.at(static_cast<std::size_t>(Rows::all)).at(stretch.axis) += 1.0;
    }
  }
}

void Design::add_forms() {
  Eigen::Index next = base_columns();
  for (const Regressor& regressor : regressors()) {
    for (std::size_t axis = 0; axis < (regressor.per_axis ? kJoints : 1); ++axis) {
      const std::vector<double> grid = regressor.grid(use_of(arm_, runs_, axis));
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const auto count = static_cast<Eigen::Index>(
            regressor.columns(runs_.front(), {arm_, axis, grid[i]}).size());
        forms_.push_back({.regressor = &regressor,
                          .axis = axis,
                          .shape = grid[i],
                          .shape_low = grid[i == 0 ? i : i - 1],
                          .shape_high = grid[std::min(i + 1, grid.size() - 1)],
                          .first = next,
                          .count = count});
        next += count;
      }
    }
  }
}

void Design::put(const std::vector<Signal>& signals,
                 std::size_t run,
                 Eigen::Ref<Eigen::MatrixXd> into) const {
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal signal = filter_(signals[i]);
    for (std::size_t axis = 0; axis < kJoints; ++axis) {
      const Stretch& stretch = stretches_[axis * runs_.size() + run];
      for (Eigen::Index k = 0; k < stretch.count; ++k) {
        if (!moves_[static_cast<std::size_t>(stretch.first + k)]) continue;
        into(stretch.first + k, static_cast<Eigen::Index>(i)) =
            signal[kEnds + kEvery * static_cast<std::size_t>(k)][static_cast<Eigen::Index>(axis)];
      }
    }
  }
}

Eigen::MatrixXd Design::columns(const Regressor& regressor, std::size_t axis, double shape) const {
  Eigen::MatrixXd result;
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const std::vector<Signal> signals = regressor.columns(runs_[run], {arm_, axis, shape});
    if (run == 0) {
      result.setZero(rows_ * static_cast<Eigen::Index>(kJoints),
                     static_cast<Eigen::Index>(signals.size()));
    }
    put(signals, run, result);
  }
  return result;
}

void Design::multiply() {
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    const auto all = columns_.middleRows(rows_ * static_cast<Eigen::Index>(axis), rows_);
    const auto product = [](const auto& rows) {
      Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
      gram.template selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
      gram.template triangularView<Eigen::StrictlyUpper>() = gram.transpose();
      return gram;
    };
    const auto slot = [&](Rows rows) -> Eigen::MatrixXd& {
      return grams_.at(static_cast<std::size_t>(rows)).at(axis);
    };
    slot(Rows::training) = product(all.topRows(rows_ - held_out_));
    slot(Rows::held_out) = product(all.bottomRows(held_out_));
    slot(Rows::all) = slot(Rows::training) + slot(Rows::held_out);
  }
}

double Design::size(Rows rows, std::size_t axis) const noexcept {
  return sizes_[static_cast<std::size_t>(rows)][axis];
}

const Eigen::MatrixXd& Design::gram(Rows rows, std::size_t axis) const noexcept {
  return grams_[static_cast<std::size_t>(rows)][axis];
}

}  // namespace teleop
