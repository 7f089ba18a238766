#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/identification/frequency_response.hpp"

namespace teleop {

/// A fitted model as it would be measured.
struct FittedCurve {
  std::string name;
  Eigen::VectorXd frequency_Hz;
  Eigen::VectorXcd gain;  ///< m/N, of the samples
};

/// The Bode plot as a gnuplot script that draws `png`: gain with 90 % intervals, noise and
/// distortion beneath it, phase; the fits drawn over.
[[nodiscard]] std::string frequency_response_picture(const std::string& title,
                                                     const std::string& png,
                                                     const FrequencyResponse& response,
                                                     const std::vector<FittedCurve>& fits);

}  // namespace teleop
