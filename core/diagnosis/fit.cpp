#include "core/diagnosis/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>
#include <glog/logging.h>

#include "core/base/error.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

using Eigen::Index;

constexpr double kBaseStep = 2.0;  // standard deviations of the prior
constexpr Index kStretch = 300;    // of three axes: a tenth of a second

/// Steps of derivatives by coordinates that are not searched by their logarithm.
double step_for(std::string_view unit) {
  struct UnitStep {
    std::string_view unit;
    double step;
  };
  constexpr std::array kSteps{UnitStep{"rad", 2e-3}, UnitStep{"1", 2e-3}, UnitStep{"N m", 2e-5},
                              UnitStep{"kg m^2", 2e-6}};
  for (const UnitStep& each : kSteps) {
    if (each.unit == unit) return each.step;
  }
  return 1e-3;
}

/// Of coordinates that are. Impacts make the errors a rough function of a play's width: its step
/// has to reach over that.
double log_step(std::string_view unit) { return unit == "rad" ? 0.04 : 0.01; }

double searched(const FreeParameter& parameter, double value) {
  return parameter.logarithmic ? std::log(std::max(value, 1e-12)) : value;
}

MachineModel with(const MachineModel& model,
                  const std::vector<FreeParameter>& free,
                  const double* coordinates) {
  MachineModel other = model;
  for (std::size_t i = 0; i < free.size(); ++i) {
    const FreeParameter& parameter = free[i];
    const double value = parameter.logarithmic ? std::exp(coordinates[i]) : coordinates[i];
    other.effects[parameter.effect].parameters[parameter.name] =
        std::clamp(value, parameter.range.low, parameter.range.high);
  }
  return other;
}

/// A model whose parameters contradict each other cannot be simulated.
bool possible(const MachineModel& model) {
  try {
    static_cast<void>(terms_of(model.effects));
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

/// The errors of all runs, one after the other, as a function of (free parameters, base).
class RunErrors final : public ceres::CostFunction {
 public:
  RunErrors(const Likelihood& likelihood,
            const MachineModel& start,
            const std::vector<FreeParameter>& free,
            const BaseColumns& base)
      : likelihood_{&likelihood}, start_{&start}, free_{&free}, base_{&base} {
    Index rows = 0;
    for (const Eigen::MatrixXf& columns : base) {
      first_.push_back(rows);
      rows += columns.rows();
    }
    volume_row_ = rows;
    start_volume_ = errors_and_volume(start).second;
    set_num_residuals(static_cast<int>(rows) + 1);
    if (!free.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(free.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(BasePrior::kSize));
  }

  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const bool has_free = !free_->empty();
    const double* x = has_free ? parameters[0] : nullptr;
    const Eigen::Map<const BasePrior::Vector> z{parameters[has_free ? 1 : 0]};
    const MachineModel here = with(*start_, *free_, x);
    if (!possible(here)) return false;
    const auto [w, volume] = errors_and_volume(here);
    Eigen::Map<Eigen::VectorXd> out{residuals, num_residuals()};
    out[volume_row_] = volume_error(volume);
    for (std::size_t run = 0; run < w.size(); ++run) {
      out.segment(first_[run], w[run].size()) =
          w[run].cast<double>() + (*base_)[run].cast<double>() * (z - start_->base);
    }
    if (!out.allFinite()) return false;
    if (jacobians == nullptr) return true;
    double* base_jacobian = jacobians[has_free ? 1 : 0];
    if (base_jacobian != nullptr) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, BasePrior::kSize, Eigen::RowMajor>> J{
          base_jacobian, num_residuals(), BasePrior::kSize};
      J.row(volume_row_).setZero();
      for (std::size_t run = 0; run < w.size(); ++run) {
        J.middleRows(first_[run], w[run].size()) = (*base_)[run].cast<double>();
      }
    }
    return !has_free || jacobians[0] == nullptr || differentiate(x, {w, volume}, jacobians[0]);
  }

 private:
  using ErrorsAndVolume = std::pair<std::vector<Eigen::VectorXf>, double>;

  [[nodiscard]] ErrorsAndVolume errors_and_volume(const MachineModel& model) const {
    ErrorsAndVolume all{std::vector<Eigen::VectorXf>(likelihood_->runs()), 0.0};
    std::vector<double> volumes(likelihood_->runs());
    for_each_index(likelihood_->runs(), likelihood_->threads(), [&](std::size_t run) {
      all.first[run] = likelihood_->errors(run, model, &volumes[run]);
    });
    for (const double each : volumes) {
      all.second += each;
    }
    return all;
  }

  /// Squared: the volume, but for a constant that keeps it positive.
  [[nodiscard]] double volume_error(double volume) const noexcept {
    constexpr double kFar = 1e5;
    return std::sqrt(std::max(kFar + volume - start_volume_, 0.0));
  }

  [[nodiscard]] bool differentiate(const double* x,
                                   const ErrorsAndVolume& here,
                                   double* out) const {
    const std::vector<Eigen::VectorXf>& w = here.first;
    const std::size_t size = free_->size();
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J{
        out, num_residuals(), static_cast<Index>(size)};
    std::vector<MachineModel> there;
    std::vector<double> steps;
    for (std::size_t i = 0; i < size; ++i) {
      std::vector<double> shifted(x, x + size);
      double step = (*free_)[i].step;
      shifted[i] = x[i] + step;
      if (!possible(with(*start_, *free_, shifted.data()))) {
        step = -step;
        shifted[i] = x[i] + step;
      }
      there.push_back(with(*start_, *free_, shifted.data()));
      steps.push_back(step);
    }
    std::vector<double> volumes(size * w.size());
    for_each_index(size * w.size(), likelihood_->threads(), [&](std::size_t job) {
      const std::size_t run = job / size;
      const std::size_t i = job % size;
      J.col(static_cast<Index>(i)).segment(first_[run], w[run].size()) =
          (likelihood_->errors(run, there[i], &volumes[job]) - w[run]).cast<double>() / steps[i];
    });
    for (std::size_t i = 0; i < size; ++i) {
      double volume = 0.0;
      for (std::size_t run = 0; run < w.size(); ++run) {
        volume += volumes[run * size + i];
      }
      J(volume_row_, static_cast<Index>(i)) =
          (volume_error(volume) - volume_error(here.second)) / steps[i];
    }
    return J.allFinite();
  }

  const Likelihood* likelihood_;
  const MachineModel* start_;
  const std::vector<FreeParameter>* free_;
  const BaseColumns* base_;
  std::vector<Index> first_;  ///< row of each run
  Index volume_row_ = 0;
  double start_volume_ = 0.0;
};

/// z ~ N(0, 1).
class PriorErrors final : public ceres::SizedCostFunction<BasePrior::kSize, BasePrior::kSize> {
 public:
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    Eigen::Map<BasePrior::Vector>{residuals} = Eigen::Map<const BasePrior::Vector>{parameters[0]};
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, BasePrior::kSize, BasePrior::kSize, Eigen::RowMajor>>{
          jacobians[0]}
          .setIdentity();
    }
    return true;
  }
};

/// Errors at the end, their slopes and the information in them.
void look_around(const Likelihood& likelihood,
                 const BaseColumns& base,
                 const FitOptions& options,
                 Fit& fit) {
  const auto p = static_cast<Index>(fit.free.size());
  const Index size = p + BasePrior::kSize;
  fit.errors.resize(likelihood.runs());
  fit.slopes.resize(options.slopes ? likelihood.runs() : 0);
  const Eigen::VectorXd x = coordinates_of(fit.model, fit.free);
  std::vector<double> volumes(likelihood.runs());
  for_each_index(likelihood.runs(), likelihood.threads(), [&](std::size_t run) {
    fit.errors[run] = likelihood.errors(run, fit.model, &volumes[run]);
    if (!options.slopes) return;
    Eigen::MatrixXf& J = fit.slopes[run];
    J.resize(fit.errors[run].size(), size);
    J.rightCols<BasePrior::kSize>() = base[run];
    for (Index i = 0; i < p; ++i) {
      const double step = fit.free[static_cast<std::size_t>(i)].step;
      Eigen::VectorXd up = x;
      Eigen::VectorXd down = x;
      up[i] += step;
      down[i] -= step;
      MachineModel above = with(fit.model, fit.free, up.data());
      MachineModel below = with(fit.model, fit.free, down.data());
      double width = 2.0 * step;
      if (!possible(above)) {
        above = fit.model;
        width = step;
      } else if (!possible(below)) {
        below = fit.model;
        width = step;
      }
      J.col(i) = (likelihood.errors(run, above) - likelihood.errors(run, below)) /
                 static_cast<float>(width);
    }
  });
  fit.chi2 = fit.model.base.squaredNorm();
  for (const double each : volumes) {
    fit.volume += each;
  }
  for (const Eigen::VectorXf& w : fit.errors) {
    fit.chi2 += w.cast<double>().squaredNorm();
  }
  if (!options.slopes) return;
  fit.information = Eigen::MatrixXd::Zero(size, size);
  fit.information.diagonal().tail<BasePrior::kSize>().setOnes();
  fit.scatter = fit.information;
  for (std::size_t run = 0; run < fit.slopes.size(); ++run) {
    const Eigen::MatrixXf& J = fit.slopes[run];
    fit.information += (J.transpose() * J).cast<double>();
    for (Index first = 0; first < J.rows(); first += kStretch) {
      const Index rows = std::min(kStretch, J.rows() - first);
      const Eigen::VectorXd pull =
          (J.middleRows(first, rows).transpose() * fit.errors[run].segment(first, rows))
              .cast<double>();
      fit.scatter += pull * pull.transpose();
    }
  }
}

}  // namespace

std::vector<FreeParameter> free_parameters(const std::vector<EffectSpec>& effects) {
  std::vector<FreeParameter> free;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    for (const EffectParameter& parameter : find_effect(effects[i].kind).parameters) {
      const std::string name{parameter.name};
      const bool given = effects[i].parameters.contains(name);
      if (parameter.role == EffectParameter::Role::given || !given) continue;
      const bool logarithmic = parameter.range.low >= 0.0;
      free.push_back({.effect = i,
                      .name = name,
                      .logarithmic = logarithmic,
                      .step = logarithmic ? log_step(parameter.unit) : step_for(parameter.unit),
                      .range = parameter.range});
    }
  }
  return free;
}

Eigen::VectorXd coordinates_of(const MachineModel& model, const std::vector<FreeParameter>& free) {
  Eigen::VectorXd x{static_cast<Index>(free.size())};
  for (std::size_t i = 0; i < free.size(); ++i) {
    x[static_cast<Index>(i)] =
        searched(free[i], model.effects[free[i].effect].parameters.at(free[i].name));
  }
  return x;
}

BaseColumns base_columns(const Likelihood& likelihood, const MachineModel& model) {
  constexpr auto kSize = static_cast<std::size_t>(BasePrior::kSize);
  const std::vector<Eigen::VectorXf> here = likelihood.errors(model);
  BaseColumns columns(likelihood.runs());
  for (std::size_t run = 0; run < likelihood.runs(); ++run) {
    columns[run].resize(here[run].size(), BasePrior::kSize);
  }
  for_each_index(likelihood.runs() * kSize, likelihood.threads(), [&](std::size_t job) {
    const std::size_t run = job / kSize;
    const auto i = static_cast<Index>(job % kSize);
    MachineModel other = model;
    other.base[i] += kBaseStep;
    columns[run].col(i) =
        (likelihood.errors(run, other) - here[run]) / static_cast<float>(kBaseStep);
  });
  return columns;
}

Eigen::VectorXd Fit::deviations() const {
  const Eigen::MatrixXd covariance =
      information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  const Eigen::MatrixXd sandwich = covariance * scatter * covariance;
  return covariance.diagonal()
      .cwiseMax(sandwich.diagonal())
      .head(static_cast<Index>(free.size()))
      .cwiseMax(0.0)
      .cwiseSqrt();
}

/// Without this run the other runs' gradient is the opposite of its own.
Eigen::VectorXd Fit::left_out_move(std::size_t run) const {
  const Eigen::MatrixXf& J = slopes[run];
  const Eigen::MatrixXd rest = information - (J.transpose() * J).cast<double>();
  return rest.ldlt().solve((J.transpose() * errors[run]).cast<double>());
}

MachineModel Fit::left_out_model(std::size_t run) const {
  const Eigen::VectorXd move = left_out_move(run);
  const auto own = static_cast<Index>(free.size());
  const Eigen::VectorXd x = coordinates_of(model, free) + move.head(own);
  MachineModel other = with(model, free, x.data());
  other.base += move.tail<BasePrior::kSize>();
  return possible(other) ? other : model;
}

Eigen::VectorXf Fit::left_out_errors(std::size_t run) const {
  return errors[run] + slopes[run] * left_out_move(run).cast<float>();
}

double Fit::left_out() const {
  double sum = 0.0;
  for (std::size_t run = 0; run < errors.size(); ++run) {
    sum += left_out_errors(run).cast<double>().squaredNorm();
  }
  return sum;
}

Fit fit(const Likelihood& likelihood,
        const BaseColumns& base,
        const MachineModel& start,
        const FitOptions& options) {
  Fit result;
  result.model = start;
  result.free = free_parameters(start.effects);
  Eigen::VectorXd x = coordinates_of(start, result.free);
  BasePrior::Vector z = start.base;

  ceres::Problem problem;
  auto* cost = new RunErrors{likelihood, start, result.free, base};  // NOLINT: ceres owns it
  if (result.free.empty()) {
    problem.AddResidualBlock(cost, nullptr, z.data());
  } else {
    problem.AddResidualBlock(cost, nullptr, x.data(), z.data());
  }
  problem.AddResidualBlock(new PriorErrors, nullptr, z.data());  // NOLINT: ceres owns it
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.iterations;
  solver.num_threads = 1;  // sums in one order; the simulations run on all cores
  solver.function_tolerance = 1e-7;
  solver.parameter_tolerance = 1e-5;
  solver.logging_type = ceres::SILENT;
  // A model that cannot be simulated is an answer, not a thing to tell the user.
  FLAGS_minloglevel = google::GLOG_FATAL;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.model = with(start, result.free, x.data());
  result.model.base = z;
  look_around(likelihood, base, options, result);
  return result;
}

}  // namespace teleop
