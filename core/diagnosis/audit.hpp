#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/diagnosis/recording.hpp"

namespace teleop {

enum class Severity : std::uint8_t { note, warning, fatal };

[[nodiscard]] const char* name_of(Severity severity) noexcept;

/// Something that is not as a recording should be.
struct Finding {
  Severity severity = Severity::note;
  std::string kind{};    ///< "gap", "swapped_columns" …
  std::string run{};     ///< Recording::name; empty: of the whole case
  std::string file{};    ///< its path; empty: of the whole case
  std::string column{};  ///< as the file names it; empty: of the whole row
  std::size_t row = 0;   ///< of the file: line, or record of a log; 0: of no row
  std::string text{};    ///< what, and what to do
};

/// "run-01.csv:17: q2_rad: text".
[[nodiscard]] std::string line_of(const Finding& finding);

struct Audit {
  std::vector<Finding> findings{};  ///< by run, in the order of the case

  [[nodiscard]] bool fatal() const noexcept;
};

/// Looks at the recordings before anything is fitted to them. Kinds, with what is fatal in
/// capitals:
///
///   time stamps   WRONG_RATE, GAP, REPEATED_TIME, jitter
///   rows          repeated_rows, TOO_SHORT, short_run, note (what reading it had to tell)
///   columns       constant_column, saturation, WRONG_READINGS (of an arm: no whole counts, or far
///                 outside its joint stops: another arm, or degrees), off_grid, off_command_step
///   motion        NO_EXCITATION, little_motion; and by regression of the commands on the inertial
///                 torques of the nominal model: WRONG_SIGN, SWAPPED_COLUMNS, WRONG_UNITS
///   currents      SWAPPED_CURRENTS: the command follows the measured torque instead of leading it
///
/// The regression takes second differences over ±h = 20 ms, whose exact counterpart is the torque
/// weighted by a triangle,
///
///     Σ_j (h − |j + ½|) τ[k+j] = M (q[k+h] − 2 q[k] + q[k−h]) / T²,   j = −h … h − 1,
///
/// with weight, speed, its sign and position of every axis beside it, so that friction, springs and
/// bias do not pass for inertia. Measured contact is taken off the commands, or stands beside them
/// too where its gain may be off. It is a check of wiring, not an estimate.
[[nodiscard]] Audit audit(const DiagnosisCase& of);

/// @throws ConfigError with the line of the first fatal finding.
void refuse_fatal(const Audit& audit);

}  // namespace teleop
