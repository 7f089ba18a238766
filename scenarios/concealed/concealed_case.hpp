#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/concealed/plan.hpp"
#include "scenarios/concealed/run.hpp"

namespace teleop::concealed {

/// One case with all that is to be kept from its reader. Drawn from the plan's seed and its own
/// index alone, so that nothing of the truth has to lie on disk.
struct ConcealedCase {
  std::string name{};  ///< "case-0001"
  Slot slot{};
  Band band = Band::invisible;      ///< as it came out
  double dnr = 0.0;                 ///< detectability over all six runs
  double dnr_held_out = 0.0;        ///< over the one held back
  std::vector<double> dnr_alone{};  ///< of each effect of a pair
  Device device;
  std::vector<Run> runs{};
};

/// @pre index < plan.cases
/// @throws ConfigError when the nominal arm's file cannot be read, or twenty draws give no device
///         that its loop can hold and whose effect is in the wanted band.
[[nodiscard]] ConcealedCase draw_case(const ConcealedPlan& plan, std::size_t index);

/// `case.toml` and five recordings, as a diagnosis may see them, into `folder`/NAME.
/// @throws RecordingError when a file cannot be written.
void write_case(const ConcealedCase& drawn, const std::filesystem::path& folder);

/// The truth and the run held back, into the same kind of folder.
/// @throws RecordingError likewise.
void write_truth(const ConcealedCase& drawn, const std::filesystem::path& folder);

/// Canonical: the same case, the same bytes.
[[nodiscard]] std::string truth_json(const ConcealedCase& drawn);

}  // namespace teleop::concealed
