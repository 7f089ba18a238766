#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/identification/mechanical_form.hpp"
#include "core/identification/transfer_function.hpp"
#include "scenarios/frequency_response_picture.hpp"

namespace teleop {

/// One fitted model as the verb reports it.
struct ResponseModel {
  std::string form;  ///< "a", "b", "free 2/2", "free 4/2"
  std::vector<Estimate> parameters;
  std::vector<Range> active_Hz;  ///< where it would give energy away; empty when passive
  bool passive = false;
  double error = 0.0;  ///< residual over noise, 1 when nothing but noise is left
  FittedCurve curve;
};

/// Forms (a) and (b) and free polynomials of the same degrees.
[[nodiscard]] std::vector<ResponseModel> fit_models(const MeasuredResponse& data,
                                                    const Sampling& sampling);

[[nodiscard]] nlohmann::json json_of(const std::vector<ResponseModel>& models);

/// For the operator: a line a model, and of the two forms the parameters with their intervals.
[[nodiscard]] std::string text_of(const std::vector<ResponseModel>& models);

}  // namespace teleop
