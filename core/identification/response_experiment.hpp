#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "core/identification/excitation_design.hpp"
#include "core/identification/frequency_response.hpp"
#include "core/identification/periodic_drive.hpp"

namespace teleop {

struct ResponseMeasurement {
  std::vector<PeriodicDrive::Outcome>
      drives{};  ///< pilot, rehearsal, measurement and its repetitions
  std::optional<FrequencyResponse> response{};  ///< absent unless all of them were done
};

/// @throws ConfigError when the lines do not fit the rate, or the numbers make no sense.
void check(const ResponseExperiment& experiment);

/// How long the arm will be driven, pilot included, s.
[[nodiscard]] double planned_duration_s(const ResponseExperiment& experiment);

/// Measures a frequency response in three drives, each from rest to rest. The pilot is a weak
/// multisine that a tool of 20 g would bear within its travel; it shows how the arm answers. From
/// that the amplitudes follow: the same force at every line, less where the line would take more
/// than its share of the travel, and as much of both as the limits allow (80 % and 70 %: the rest
/// is for the holding loop and for what the pilot did not see). A rehearsal at half of that shows
/// how the arm answers once friction holds it less; the measurement takes its amplitudes from
/// there.
///
/// The arm must stand still, and must not be touched. Clock and arm may be simulated or real.
/// Records that lost too many periods to a late loop give no response.
/// @throws ConfigError as check() does.
[[nodiscard]] ResponseMeasurement measure_response(const ResponseExperiment& experiment,
                                                   Arm& arm,
                                                   const ArmModel& model,
                                                   Clock& clock,
                                                   const std::atomic<bool>& stop);

}  // namespace teleop
