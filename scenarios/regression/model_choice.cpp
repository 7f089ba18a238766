#include "scenarios/regression/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

namespace teleop {
namespace {

constexpr std::size_t kTried = 5;  // candidates that the left-out run may refuse
constexpr int kSwaps = 4;
constexpr Eigen::Index kLongest = 60;  // rows of an autocorrelation
constexpr double kUncorrelated = 0.05;

std::vector<Eigen::Index> columns_of(const Design& design, const ModelChoice::Choice& choice) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(Design::base_columns()));
  std::iota(columns.begin(), columns.end(), 0);
  for (const std::size_t index : choice) {
    const Form& form = design.forms()[index];
    for (Eigen::Index i = 0; i < form.count; ++i) {
      columns.push_back(form.first + i);
    }
  }
  return columns;
}

double freedom(const Design& design, const ModelChoice::Choice& choice) {
  double sum = 0.0;
  for (const std::size_t index : choice) {
    sum += design.forms()[index].freedom();
  }
  return sum;
}

/// Sums of squares of the rows under given coefficients.
JointVector rss_of(const Design& design,
                   Rows rows,
                   const std::vector<Eigen::Index>& columns,
                   const Eigen::VectorXd& coefficients) {
  JointVector rss = JointVector::Zero();
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    const Eigen::MatrixXd& gram = design.gram(rows, axis);
    const Eigen::VectorXd b = gram(columns, design.target());
    const Eigen::MatrixXd A = gram(columns, columns);
    rss[static_cast<Eigen::Index>(axis)] = gram(design.target(), design.target()) -
                                           2.0 * coefficients.dot(b) +
                                           coefficients.dot(A * coefficients);
  }
  return rss.cwiseMax(1e-30);
}

}  // namespace

ModelChoice::Noise noise_of(const Design& design, const Eigen::VectorXd& residuals) {
  ModelChoice::Noise noise;
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    Eigen::VectorXd products = Eigen::VectorXd::Zero(kLongest);
    for (const Design::Stretch& stretch : design.stretches()) {
      if (stretch.axis != axis) continue;
      const auto rows = residuals.segment(stretch.first, stretch.count);
      const Eigen::Index longest = std::min(kLongest, stretch.count);
      for (Eigen::Index lag = 0; lag < longest; ++lag) {
        products[lag] += rows.head(stretch.count - lag).dot(rows.tail(stretch.count - lag));
      }
    }
    if (products[0] <= 0.0) continue;  // the axis never moved
    double length = 1.0;
    for (Eigen::Index lag = 1; lag < kLongest; ++lag) {
      const double correlation = products[lag] / products[0];
      if (correlation < kUncorrelated) break;
      length += 2.0 * correlation;
    }
    const auto i = static_cast<Eigen::Index>(axis);
    noise.variance[i] = products[0] / std::max(1.0, design.size(Rows::all, axis));
    noise.length[i] = length;
  }
  return noise;
}

ModelChoice::ModelChoice(const Design& design, Counting counting)
    : design_{design}, counting_{counting} {
  for (int i = 0; i < 3; ++i) {
    measure_noise();  // weights and noise settle on each other
  }
  while (chosen_.size() < kMostEffects && add()) {
    measure_noise();
    for (int i = 0; i < kSwaps && swap(); ++i) {
      measure_noise();
    }
  }
}

double ModelChoice::weight(std::size_t axis) const {
  const auto i = static_cast<Eigen::Index>(axis);
  return 1.0 / (noise_.variance[i] * (counting_ == Counting::correlated ? noise_.length[i] : 1.0));
}

void ModelChoice::measure_noise() {
  const Fitted fitted = fit(chosen_, Rows::all);
  Eigen::VectorXd residuals = design_.column(design_.target());
  const std::vector<Eigen::Index> columns = columns_of(design_, chosen_);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    residuals -= fitted.coefficients[static_cast<Eigen::Index>(i)] * design_.column(columns[i]);
  }
  noise_ = noise_of(design_, residuals);
}

ModelChoice::Fitted ModelChoice::fit(const Choice& choice, Rows rows) const {
  const std::vector<Eigen::Index> columns = columns_of(design_, choice);
  const auto size = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    const Eigen::MatrixXd& gram = design_.gram(rows, axis);
    A += weight(axis) * gram(columns, columns);
    b += weight(axis) * gram(columns, design_.target());
  }
  const Eigen::Index base = Design::base_columns();
  A.diagonal().head(base).array() += 1.0;
  const Eigen::VectorXd unit = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * A * unit.asDiagonal();
  Fitted result;
  result.coefficients = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(b)));
  result.rss = rss_of(design_, rows, columns, result.coefficients);
  double counted = 0.0;
  for (Eigen::Index i = 0; i < result.rss.size(); ++i) {
    const double n = std::max(1.0, design_.size(rows, static_cast<std::size_t>(i)));
    const double worth = counting_ == Counting::correlated ? n / noise_.length[i] : n;
    result.bic += worth * std::log(result.rss[i] / n);
    counted += worth;
  }
  result.bic += result.coefficients.head(base).squaredNorm();
  result.bic += freedom(design_, choice) * std::log(counted);
  if (!result.coefficients.allFinite()) result.bic = std::numeric_limits<double>::infinity();
  return result;
}

bool ModelChoice::possible(const Choice& choice, const Fitted& fitted) const {
  Eigen::Index next = Design::base_columns();
  for (const std::size_t index : choice) {
    const Form& form = design_.forms()[index];
    Regressor::Estimate estimate{.shape = form.shape};
    for (Eigen::Index i = 0; i < form.count; ++i) {
      estimate.coefficients.push_back(fitted.coefficients[next++]);
      estimate.deviations.push_back(0.0);
    }
    if (!form.regressor->parameters(estimate, {design_.arm(), form.axis, form.shape})) return false;
  }
  return true;
}

JointVector ModelChoice::left_out(const Choice& choice) const {
  const Fitted fitted = fit(choice, Rows::training);
  const JointVector rss =
      rss_of(design_, Rows::held_out, columns_of(design_, choice), fitted.coefficients);
  JointVector mean = JointVector::Zero();
  for (std::size_t axis = 0; axis < kJoints; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    mean[i] = rss[i] / (std::max(1.0, design_.size(Rows::held_out, axis)) * noise_.variance[i]);
  }
  return mean;
}

double ModelChoice::held_out_score(const Choice& choice) const {
  const JointVector left = left_out(choice);
  double score = 0.0;
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const double n = design_.size(Rows::held_out, static_cast<std::size_t>(i));
    score += (counting_ == Counting::correlated ? n / noise_.length[i] : n) * std::log(left[i]);
  }
  return score;
}

bool ModelChoice::taken(const Form& form, const Choice& by) const {
  return std::any_of(by.begin(), by.end(),
                     [&](std::size_t index) { return form.same_name(design_.forms()[index]); });
}

bool ModelChoice::add() {
  std::vector<std::pair<double, std::size_t>> better;
  const double now = fit(chosen_, Rows::training).bic;
  for (std::size_t index = 0; index < design_.forms().size(); ++index) {
    if (taken(design_.forms()[index], chosen_)) continue;
    Choice larger = chosen_;
    larger.push_back(index);
    const Fitted fitted = fit(larger, Rows::training);
    if (fitted.bic < now && possible(larger, fitted)) better.emplace_back(fitted.bic, index);
  }
  std::sort(better.begin(), better.end());
  const double before = held_out_score(chosen_);
  for (std::size_t i = 0; i < std::min(kTried, better.size()); ++i) {
    Choice larger = chosen_;
    larger.push_back(better[i].second);
    if (held_out_score(larger) >= before) continue;
    chosen_ = std::move(larger);
    return true;
  }
  return false;
}

bool ModelChoice::swap() {
  double least = fit(chosen_, Rows::training).bic;
  Choice best = chosen_;
  for (std::size_t place = 0; place < chosen_.size(); ++place) {
    Choice others = chosen_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
    for (std::size_t index = 0; index < design_.forms().size(); ++index) {
      if (taken(design_.forms()[index], others)) continue;
      Choice other = chosen_;
      other[place] = index;
      const Fitted fitted = fit(other, Rows::training);
      if (fitted.bic < least - 1e-6 && possible(other, fitted)) {
        least = fitted.bic;
        best = other;
      }
    }
  }
  return std::exchange(chosen_, best) != best;
}

}  // namespace teleop
