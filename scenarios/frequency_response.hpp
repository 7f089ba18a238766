#pragma once

#include <string>

#include "core/identification/excitation_design.hpp"
#include "core/identification/linear_model.hpp"

namespace teleop {

struct FrequencyResponseOptions {
  std::string device = "sim";
  std::string axis = "x";            ///< x, y or z
  std::string method = "multisine";  ///< or stepped-sine
  /// Axis and excitation come from the two above.
  ResponseExperiment experiment{.gravity_share = 1.0};
  int delay_samples = 0;          ///< of the device, known beforehand
  double amplifier_lag_ms = 0.0;  ///< the same
  bool real_time = false;         ///< a simulated arm on the machine's clock too
  bool yes = false;               ///< do not ask before a real arm moves
  std::string out = ".";          ///< folder, made when absent
  std::string json;               ///< also write the numbers there
};

/// `teleop frequency-response`: drives an arm along one tool axis, and fits both forms of the paper
/// and free polynomials to what it answers. Writes frequency-response-AXIS.png, .csv and .json.
///
/// Before anything moves it says what will; an arm that is not simulated waits for a yes.
/// @returns 0; 1 when the measurement was stopped or nothing could be drawn.
/// @throws ConfigError, DeviceError: bad options, no such device, a folder that cannot be written.
[[nodiscard]] int run_frequency_response(const FrequencyResponseOptions& options);

}  // namespace teleop
