#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/diagnosis/free_run.hpp"
#include "core/diagnosis/leftover.hpp"
#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/localisation.hpp"
#include "core/diagnosis/next_experiment.hpp"
#include "core/diagnosis/search.hpp"

namespace teleop {

enum class Verdict { adequate, explained, partly_explained, unexplained };

[[nodiscard]] std::string_view text_of(Verdict verdict) noexcept;

/// How well models predict runs that their parameters were not fitted to: RMS of the whitened
/// innovations on the axis that the nominal model misses most. 1: nothing is left but noise.
struct HeldOutFit {
  double nominal = 0.0;
  double corrected = 0.0;
  double floor = 1.0;
  std::vector<std::string> runs{};  ///< each was left out in turn
};

/// What a search found, judged.
struct Diagnosis {
  SearchResult found{};
  Verdict verdict = Verdict::adequate;
  double p_value = 1.0;  ///< that recordings of the nominal machine look so
  std::vector<Leftover> leftovers{};
  HeldOutFit fit{};
  std::vector<double> confidences{};                     ///< of each effect
  std::vector<std::vector<double>> rival_confidences{};  ///< of each effect's rivals
  Localisation where{};
  FreeRun free{};
  NextExperiment next{};
};

/// Searches, looks at what is left over and judges.
[[nodiscard]] Diagnosis diagnose(Likelihood& likelihood, const SearchOptions& options);

/// Where the nominal model misses the recordings, and what is left, in a line.
[[nodiscard]] std::string where_of(const Diagnosis& diagnosis);

/// The answer as scripts read it (docs/diagnosis.md).
[[nodiscard]] nlohmann::ordered_json answer_of(const Diagnosis& diagnosis,
                                               const DiagnosisCase& data);

}  // namespace teleop
