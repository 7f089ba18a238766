#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/diagnosis/report.hpp"

namespace teleop {

/// Standard errors of the fitted parameters of an effect, by name and in their own units.
[[nodiscard]] std::map<std::string, double> deviations_of(const NamedEffect& named);

/// The effect in a sentence, with its standard errors.
[[nodiscard]] std::string sentence_of(const NamedEffect& named);

/// "coulomb friction, axis 2"
[[nodiscard]] std::string title_of(const EffectSpec& effect);

/// Parts of the page as HTML.
[[nodiscard]] std::string effect_table(const Diagnosis& diagnosis);
[[nodiscard]] std::string rival_table(const Diagnosis& diagnosis);
[[nodiscard]] std::string leftover_table(const Diagnosis& diagnosis);
[[nodiscard]] std::string audit_list(const Audit& audit);
[[nodiscard]] std::string next_part(const ReportedDiagnosis& reported);
[[nodiscard]] std::string method_part(const Diagnosis& diagnosis, const DiagnosisCase& data);

[[nodiscard]] std::string map_charts(const Diagnosis& diagnosis);
[[nodiscard]] std::string profile_charts(const Diagnosis& diagnosis);
[[nodiscard]] std::string spectrum_charts(const Diagnosis& diagnosis);

/// Charts of the stretch of a run where the nominal model goes astray most, and what they show.
struct TraceCharts {
  std::string note{};
  std::string html{};
};
[[nodiscard]] TraceCharts trace_charts(const Diagnosis& diagnosis, const DiagnosisCase& data);

}  // namespace teleop
