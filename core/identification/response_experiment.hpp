#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/identification/frequency_response.hpp"
#include "core/identification/periodic_drive.hpp"

namespace teleop {

enum class Excitation : std::uint8_t { multisine, stepped_sine };

/// What to measure, and how far the arm may go for it.
struct ResponseExperiment {
  std::size_t axis = 0;  ///< 0 to 2: x, y, z
  Excitation excitation = Excitation::multisine;
  double rate_Hz = 10000.0;
  double low_Hz = 3.0;
  double high_Hz = 500.0;
  double period_s = 1.0;     ///< the resolution is its inverse
  int periods = 3;           ///< kept of every realisation or line
  int realisations = 6;      ///< of the multisine, with other phases each
  int lines = 40;            ///< of the stepped sine
  double max_force_N = 3.0;  ///< commanded, holding loop included
  double max_travel_m = 0.005;
  std::uint64_t seed = 1;  ///< of lines and phases
};

struct ResponseMeasurement {
  PeriodicDrive::Outcome pilot;
  PeriodicDrive::Outcome drive;               ///< running when the pilot did not get through
  std::optional<FrequencyResponse> response;  ///< absent unless both were done
};

/// How long the arm will be driven, pilot included, s.
[[nodiscard]] double planned_duration_s(const ResponseExperiment& experiment);

/// Measures a frequency response in two drives, each from rest to rest. The pilot is a weak
/// multisine that a tool of 20 g would bear within its travel; it shows how the arm answers. From
/// that the amplitudes follow: the same force at every line, less where the line would take more
/// than its share of the travel, and as much of both as the limits allow (80 % and 70 %: the rest
/// is for the holding loop and for what the pilot did not see).
///
/// The arm must stand still, and must not be touched. Clock and arm may be simulated or real.
/// Records that lost too many periods to a late loop give no response.
/// @throws ConfigError when the lines do not fit the rate, or the numbers make no sense.
[[nodiscard]] ResponseMeasurement measure_response(const ResponseExperiment& experiment,
                                                   Arm& arm,
                                                   const ArmModel& model,
                                                   Clock& clock,
                                                   const std::atomic<bool>& stop);

}  // namespace teleop
