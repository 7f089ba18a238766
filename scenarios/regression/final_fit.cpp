#include "scenarios/regression/final_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace teleop {
namespace {

constexpr double kGolden = 0.6180339887498949;
constexpr int kCuts = 12;
constexpr int kPasses = 2;

Eigen::VectorXd weights_of(const Design& design,
                           const ModelChoice::Noise& noise,
                           Counting counting) {
  Eigen::VectorXd weights(design.column(0).size());
  for (const Design::Stretch& stretch : design.stretches()) {
    const auto i = static_cast<Eigen::Index>(stretch.axis);
    const double length = counting == Counting::correlated ? noise.length[i] : 1.0;
    weights.segment(stretch.first, stretch.count).setConstant(1.0 / (noise.variance[i] * length));
  }
  return weights;
}

struct Solved {
  Eigen::VectorXd coefficients{};
  Eigen::MatrixXd inverse{};
  double chi2 = 0.0;
};

Solved solve(const Eigen::MatrixXd& X, const Eigen::VectorXd& y, const Eigen::VectorXd& weights) {
  const Eigen::MatrixXd WX = weights.asDiagonal() * X;
  Eigen::MatrixXd A = X.transpose() * WX;
  A.diagonal().head(Design::base_columns()).array() += 1.0;
  const Eigen::VectorXd b = WX.transpose() * y;
  const Eigen::VectorXd unit = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factors{
      Eigen::MatrixXd{unit.asDiagonal() * A * unit.asDiagonal()}};
  Solved result;
  result.coefficients = unit.cwiseProduct(factors.solve(unit.cwiseProduct(b)));
  result.inverse = unit.asDiagonal() *
                   factors.solve(Eigen::MatrixXd::Identity(A.rows(), A.cols())) * unit.asDiagonal();
  result.chi2 = y.dot(weights.cwiseProduct(y)) - result.coefficients.dot(b);
  return result;
}

/// Where the columns of one form stand and how far its shape may move.
struct Slot {
  const Form* form = nullptr;
  Eigen::Index first = 0;
  double shape = 0.0;
  double shape_deviation = 0.0;
};

class Refinement {
 public:
  Refinement(const Design& design, FinalFit& fit) : design_{design}, fit_{fit} {}

  /// χ² with another shape in the slot; its columns stay in place.
  double at(const Slot& slot, double shape) {
    fit_.columns.middleCols(slot.first, slot.form->count) =
        design_.columns(*slot.form->regressor, slot.form->axis, shape);
    return solve(fit_.columns, design_.column(design_.target()), fit_.weights).chi2;
  }

  void refine(Slot& slot) {
    double low = slot.form->shape_low;
    double high = slot.form->shape_high;
    double inner = high - kGolden * (high - low);
    double outer = low + kGolden * (high - low);
    double at_inner = at(slot, inner);
    double at_outer = at(slot, outer);
    for (int cut = 0; cut < kCuts; ++cut) {
      if (at_inner < at_outer) {
        high = outer;
        outer = inner;
        at_outer = at_inner;
        inner = high - kGolden * (high - low);
        at_inner = at(slot, inner);
      } else {
        low = inner;
        inner = outer;
        at_inner = at_outer;
        outer = low + kGolden * (high - low);
        at_outer = at(slot, outer);
      }
    }
    slot.shape = (low + high) / 2.0;
    measure_curvature(slot);
    at(slot, slot.shape);
  }

 private:
  void measure_curvature(Slot& slot) {
    const double step = 0.02 * (slot.form->shape_high - slot.form->shape_low);
    const double curvature =
        (at(slot, slot.shape + step) - 2.0 * at(slot, slot.shape) + at(slot, slot.shape - step)) /
        (step * step);
    if (curvature > 0.0) slot.shape_deviation = std::sqrt(2.0 / curvature);
  }

  const Design& design_;
  FinalFit& fit_;
};

std::vector<Slot> slots_of(const Design& design, const ModelChoice& choice, FinalFit& fit) {
  std::vector<Slot> slots;
  slots.reserve(choice.chosen().size());
  Eigen::Index width = Design::base_columns();
  for (const std::size_t index : choice.chosen()) {
    const Form& form = design.forms()[index];
    slots.push_back({.form = &form, .first = width, .shape = form.shape});
    width += form.count;
  }
  fit.columns.resize(design.column(0).size(), width);
  for (Eigen::Index i = 0; i < Design::base_columns(); ++i) {
    fit.columns.col(i) = design.column(i);
  }
  for (const Slot& slot : slots) {
    for (Eigen::Index i = 0; i < slot.form->count; ++i) {
      fit.columns.col(slot.first + i) = design.column(slot.form->first + i);
    }
  }
  return slots;
}

}  // namespace

FinalFit final_fit(const Design& design, const ModelChoice& choice, Counting counting) {
  FinalFit fit;
  fit.weights = weights_of(design, choice.noise(), counting);
  std::vector<Slot> slots = slots_of(design, choice, fit);
  Refinement refinement{design, fit};
  for (int pass = 0; pass < kPasses; ++pass) {
    for (Slot& slot : slots) {
      if (slot.form->regressor->continuous) refinement.refine(slot);
    }
  }
  const Eigen::VectorXd target = design.column(design.target());
  const Solved solved = solve(fit.columns, target, fit.weights);
  fit.inverse = solved.inverse;
  fit.residuals = target - fit.columns * solved.coefficients;
  fit.effects.reserve(slots.size());
  for (const Slot& slot : slots) {
    Regressor::Estimate estimate{.shape = slot.shape, .shape_deviation = slot.shape_deviation};
    for (Eigen::Index i = slot.first; i < slot.first + slot.form->count; ++i) {
      estimate.coefficients.push_back(solved.coefficients[i]);
      estimate.deviations.push_back(std::sqrt(std::max(0.0, solved.inverse(i, i))));
    }
    fit.effects.push_back(
        {.regressor = slot.form->regressor, .axis = slot.form->axis, .estimate = estimate});
  }
  return fit;
}

double gain_of(const FinalFit& fit, const Eigen::VectorXd& column) {
  const Eigen::VectorXd weighted = fit.weights.cwiseProduct(column);
  const Eigen::VectorXd shared = fit.columns.transpose() * weighted;
  const double own = column.dot(weighted) - shared.dot(fit.inverse * shared);
  const double slope = weighted.dot(fit.residuals);
  return own > 1e-9 * column.dot(weighted) ? slope * slope / own : 0.0;
}

}  // namespace teleop
