#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace teleop {

struct VelocityOptions {
  std::vector<std::string> logs{};      ///< recordings; none: an arm is read
  std::string device = "sim";           ///< that arm; of a simulated one the truth is known
  std::string hand = "reach";           ///< what moves a simulated one
  bool real_time = false;               ///< reads a simulated arm on the machine's clock too
  std::uint64_t seed = 1;               ///< of its motion
  double seconds = 20.0;                ///< of reading
  double rate_Hz = 1000.0;              ///< readings a second
  std::string arm{};                    ///< of recordings; empty: what they name
  double reference_Hz = 25.0;           ///< bandwidth of the reference where there is no truth
  std::vector<std::string> settings{};  ///< KEY=VALUE, keys as the stations' velocity.…
  bool print_config = false;            ///< only print the estimators' settings
  double mass_g = 0.0;                  ///< of the tool in the damping loop; 0: the arm's at home
  double damping_Ns_per_m = 1.115;      ///< physical, at the tool
  double amplitude_mm = 0.0;  ///< of the marginal oscillation; 0: 10 counts, at least 0.3 mm
  std::string out = ".";      ///< folder of the pictures, made when absent
  std::string json{};         ///< also write the numbers there; empty: nowhere
};

/// `teleop velocity`: every velocity estimator on the same readings, side by side: noise, lag and
/// worst error by speed, and the largest virtual damping that each allows.
///
/// @returns 0, or 1 when gnuplot is absent or refuses: then everything but the pictures is there.
/// @throws ConfigError, DeviceError, RecordingError: an option, a setting, a device or a recording
/// cannot be used.
[[nodiscard]] int run_velocity(const VelocityOptions& options);

}  // namespace teleop
