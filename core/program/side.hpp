#pragma once

#include "core/ports/link_plug.hpp"
#include "core/ports/peer.hpp"

namespace teleop {

/// One side of the pair as a process: reads the command line, opens arm, link and recording, runs
/// the loop in a real-time thread, shows a status, ends with torques at zero and the recording
/// closed on SIGINT, SIGTERM or after the asked time.
///
/// @returns 0 done, 1 when the run ended in a fault.
/// @throws Error on bad input.
[[nodiscard]] int run_side(Role role, int argc, char** argv, const LinkPlug& plug);

}  // namespace teleop
