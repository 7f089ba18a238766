#pragma once

#include <iosfwd>

#include "core/recording/log.hpp"

namespace teleop {

/// Writes the ticks of a log as comma-separated values: a head line, then a line a tick and a
/// column a number. Columns are named as Foxglove and PlotJuggler show the fields: "stamp_ns",
/// "q_rad[0]". What some devices alone measure (Field::only_with) has columns where some tick has
/// it. Numbers read back to the same bits.
void export_csv(const Log& log, std::ostream& out);

}  // namespace teleop
