#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/tuning/tune_point.hpp"

namespace teleop {

struct TuneOptions {
  std::string experiment = "wall";
  std::string device = "sim";
  std::string master = "sim";
  std::string slave = "sim";
  std::string axis = "y";
  std::string hand = "none";
  int points = 1;
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  std::vector<double> map_damping;  ///< K–B map: the dampings at which the stiffness is looked for
  std::string velocity = "difference";
  int mean_samples = 100;
  double cutoff_Hz = 300.0;
  int peer_delay_samples = 0;
  double amplitude_mm = 0.0;
  double width_percent = 1.0;
  double most_seconds = 120.0;
  double rate_Hz = 1000.0;
  ProbeBounds bounds{};
  bool real_time = false;
  bool resume = false;
  std::uint64_t seed = 1;
  std::string out = ".";
  std::string json;
};

/// One search of a run: where, along which axis, with which fixed damping.
struct TuneJob {
  JointVector q = JointVector::Zero();
  std::size_t axis = 0;
  double damping_Ns_per_m = 0.0;
};

/// A search that has ended.
struct TunedPoint {
  TuneJob job{};
  PointResult result{};
  std::optional<double> analytic_gain{};  ///< of the rigid arm with its viscous friction
};

/// Tunes every pose and axis, draws, reports. @returns the exit code: 0, or 1 when some search
/// found no gain or was stopped.
/// @throws ConfigError, DeviceError before anything moves.
[[nodiscard]] int run_tune(const TuneOptions& options);

}  // namespace teleop
