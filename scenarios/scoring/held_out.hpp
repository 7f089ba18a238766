#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scenarios/concealed/concealed_case.hpp"

namespace teleop {

/// How much worse the answer's effects predict the run held back than the true ones: RMS of the
/// innovations of the concealed plant with the answer's effects over that with the true effects,
/// the axis where it is largest. Rigid body, tether and noise are the true ones on both sides, as
/// in the DNR: what is judged is the physics that was named. A model that cannot
/// predict anything counts as 1e6.
/// @pre the truth is within the vocabulary.
[[nodiscard]] double held_out_over_true(const concealed::ConcealedCase& drawn,
                                        const nlohmann::json& answer);

}  // namespace teleop
