#pragma once

#include <string>
#include <vector>

#include "core/diagnosis/leftover.hpp"
#include "core/diagnosis/localisation.hpp"

namespace teleop {

/// Fills Localisation::where, ::left_over and ::axis from the figures: which axes, what the missing
/// torque follows, in which runs and at which frequencies.
/// @param runs names of the recordings
void put_in_words(Localisation& found, const std::vector<std::string>& runs);

/// "a torque of about 1.1 mNm that follows size of speed"
[[nodiscard]] std::string text_of(const Leftover& leftover);

}  // namespace teleop
