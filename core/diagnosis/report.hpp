#pragma once

#include <string>
#include <vector>

#include "core/diagnosis/answer.hpp"
#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/recording.hpp"

namespace teleop {

/// A diagnosis with what it is about. Refers to its parts: they must outlive it.
struct ReportedDiagnosis {
  const Diagnosis& diagnosis;
  const DiagnosisCase& data;
  const Audit& audit;
  std::string next_file{};  ///< scenario of the next experiment, as it was written; empty: none
};

/// What was found, in a sentence: "Axis 2 loses 11 ± 1 mNm against every motion: dry friction."
[[nodiscard]] std::string headline_of(const Diagnosis& diagnosis);

/// What follows the headline: further effects, and how much better the corrected model does.
[[nodiscard]] std::vector<std::string> story_of(const Diagnosis& diagnosis);

/// A page about one case that needs nothing else: no network, no other file, no script.
[[nodiscard]] std::string diagnosis_page(const ReportedDiagnosis& reported);

/// A row of the page that leads to the pages of several cases.
struct IndexEntry {
  std::string name{};
  std::string file{};  ///< relative to the page
  std::string verdict{};
  std::string headline{};
};
[[nodiscard]] std::string index_page(const std::vector<IndexEntry>& entries);

}  // namespace teleop
