#include "scenarios/frequency_response_fits.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/identification/polynomial_fit.hpp"

namespace teleop {
namespace {

using nlohmann::json;

constexpr double kNormal95 = 1.6449;
constexpr Eigen::Index kCurvePoints = 600;

FittedCurve curve(const std::string& name,
                  Linearised system,
                  const MeasuredResponse& data,
                  const Sampling& sampling) {
  system.derivatives.clear();
  const double low = std::log(data.frequency_Hz.minCoeff());
  const double high = std::log(data.frequency_Hz.maxCoeff());
  FittedCurve result{.name = name, .frequency_Hz = {}, .gain = {}};
  result.frequency_Hz = Eigen::ArrayXd::LinSpaced(kCurvePoints, low, high).exp();
  result.gain = sampled_response(system, sampling, result.frequency_Hz).value;
  return result;
}

ResponseModel form_model(MechanicalForm form,
                         const MeasuredResponse& data,
                         const Sampling& sampling) {
  const MechanicalFit fit = fit_mechanical(form, data, sampling);
  const std::string name = form == MechanicalForm::a ? "a" : "b";
  return {.form = name,
          .parameters = fit.estimates,
          .active_Hz = {},
          .passive = true,  // by construction: every parameter is positive
          .error = fit.fit.error,
          .curve = curve("form (" + name + ")", fit.family(fit.fit.theta), data, sampling)};
}

/// The coefficients of a polynomial but a leading one, as estimates.
void add_coefficients(std::vector<Estimate>& estimates,
                      std::span<const std::string_view> names,
                      const Eigen::VectorXd& values,
                      const Eigen::VectorXd& deviations) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (deviations(i) == 0.0) continue;
    const auto power = static_cast<std::size_t>(values.size() - 1 - i);
    estimates.push_back({.name = names[power],
                         .unit = "SI",
                         .value = values(i),
                         .deviation = deviations(i),
                         .low = values(i) - kNormal95 * deviations(i),
                         .high = values(i) + kNormal95 * deviations(i)});
  }
}

ResponseModel free_model(const PolynomialOrder& order,
                         const MeasuredResponse& data,
                         const Sampling& sampling) {
  static constexpr std::array<std::string_view, 5> kNumerator{"n0", "n1", "n2", "n3", "n4"};
  static constexpr std::array<std::string_view, 3> kDenominator{"d0", "d1", "d2"};
  const PolynomialFit fit = fit_polynomial(order, data, sampling);
  ResponseModel model{.form = fmt::format("free {}/{}", order.numerator, order.denominator),
                      .parameters = {},
                      .active_Hz = fit.passivity.active_Hz,
                      .passive = fit.passivity.passive,
                      .error = fit.fit.error,
                      .curve = {}};
  add_coefficients(model.parameters, kNumerator, fit.P.numerator, fit.deviation.numerator);
  add_coefficients(model.parameters, kDenominator, fit.P.denominator, fit.deviation.denominator);
  model.curve = curve(model.form, {.model = realisation(fit.P), .derivatives = {}}, data, sampling);
  return model;
}

std::string active_text(const std::vector<Range>& ranges) {
  if (ranges.empty()) return "not stable";
  std::string text;
  for (const Range& range : ranges) {
    text += text.empty() ? "active " : " and ";
    text += std::isfinite(range.high)
                ? fmt::format("from {:.1f} to {:.1f} Hz", range.low, range.high)
                : fmt::format("above {:.1f} Hz", range.low);
  }
  return text;
}

std::string line_of(const Estimate& estimate) {
  if (!estimate.determined) {
    return fmt::format("  {:<4} not determined by these lines\n", estimate.name);
  }
  return fmt::format("  {:<4} {:>10.4g} {:<6} 90 % {:.4g} to {:.4g}\n", estimate.name,
                     estimate.value, estimate.unit, estimate.low, estimate.high);
}

}  // namespace

std::vector<ResponseModel> fit_models(const MeasuredResponse& data, const Sampling& sampling) {
  return {form_model(MechanicalForm::a, data, sampling),
          form_model(MechanicalForm::b, data, sampling),
          free_model({.numerator = 2, .denominator = 2}, data, sampling),
          free_model({.numerator = 4, .denominator = 2}, data, sampling)};
}

nlohmann::json json_of(const std::vector<ResponseModel>& models) {
  json result = json::array();
  for (const ResponseModel& model : models) {
    json parameters = json::array();
    for (const Estimate& estimate : model.parameters) {
      parameters.push_back({{"name", estimate.name},
                            {"value", estimate.value},
                            {"std", estimate.deviation},
                            {"low", estimate.low},
                            {"high", estimate.high},
                            {"determined", estimate.determined},
                            {"unit", estimate.unit}});
    }
    json active = json::array();
    for (const Range& range : model.active_Hz) {
      const json high = std::isfinite(range.high) ? json(range.high) : json(nullptr);
      active.push_back(json::array({range.low, high}));
    }
    result.push_back({{"form", model.form},
                      {"passive", model.passive},
                      {"active_Hz", active},
                      {"parameters", parameters},
                      {"error", model.error}});
  }
  return result;
}

std::string text_of(const std::vector<ResponseModel>& models) {
  std::string text;
  for (const ResponseModel& model : models) {
    fmt::format_to(std::back_inserter(text), "{:<9} error {:7.3f}  {}\n", model.form, model.error,
                   model.passive ? "passive" : "not passive: " + active_text(model.active_Hz));
    if (model.form.size() > 1) continue;
    for (const Estimate& estimate : model.parameters) {
      text += line_of(estimate);
    }
  }
  return text;
}

}  // namespace teleop
