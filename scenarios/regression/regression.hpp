#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/diagnosis/recording.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/regression/design.hpp"
#include "scenarios/regression/model_choice.hpp"

namespace teleop {

/// Inverse-dynamics regression as a researcher would write it, the peer that a diagnosis is held
/// against: zero-phase filters, central differences, grids for what is not linear, forward
/// selection with swaps by BIC, a run left out as veto, at most four effects, a test for what is
/// left. It names from differentiated data of a closed loop and takes its residuals for white or
/// nearly so, with the known consequences (docs/diagnosis.md).
/// @returns an answer in the agreed format.
/// @pre design is of `data`
[[nodiscard]] nlohmann::ordered_json regress(const Design& design,
                                             const DiagnosisCase& data,
                                             Counting counting);

}  // namespace teleop
