#pragma once

#include <filesystem>

#include "core/experiment/sweep_plan.hpp"
#include "core/experiment/sweep_store.hpp"

namespace teleop {

/// Draws every result that is not the same at all points into the sweep's folder, RESULT.png each:
/// a line over one axis, a heat map over two, coloured marks where two axes make no grid. Over more
/// axes there are no pictures.
/// @returns whether all that can be drawn is drawn; what is not is said on stderr.
[[nodiscard]] bool draw_sweep(const SweepPlan& plan, const SweepStore& store);

}  // namespace teleop
