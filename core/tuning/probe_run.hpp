#pragma once

#include <functional>
#include <vector>

#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/realtime/loop.hpp"
#include "core/tuning/probe.hpp"

namespace teleop {

/// Lets probes run on arms behind the port, on any clock. While somebody thinks about what a probe
/// showed the arms are held at the safe gain by a loop that goes on; on a clock that moves only
/// when it is slept on, time stands still instead, so that results do not depend on the machine.
///
/// Thread: one; think_about() runs the thought on a second one where time does not wait.
class ProbeRunner {
 public:
  struct Ports {
    std::vector<Arm*> arms{};  ///< one, or master and slave
    Clock* clock = nullptr;
    bool time_waits = false;  ///< the clock is a simulated one
    double period_s = 1e-3;
  };

  /// How well the loop kept time during a probe.
  struct Timing {
    int missed_turns = 0;
    double arm_seconds = 0.0;  ///< on the clock, thinking included where time does not wait
  };

  /// Turns the amplifiers on. Ports, probe and loop must outlive it.
  ProbeRunner(const Ports& ports, Probe& probe, LoopUnderTest& loop);
  ProbeRunner(const ProbeRunner&) = delete;
  ProbeRunner& operator=(const ProbeRunner&) = delete;
  ProbeRunner(ProbeRunner&&) = delete;
  ProbeRunner& operator=(ProbeRunner&&) = delete;

  /// Torques zero, amplifiers off.
  ~ProbeRunner();

  /// Runs a probe to its end. `stop_asked` may become true at any time from elsewhere.
  Timing run(const ProbePlan& plan, const std::function<bool()>& stop_asked);

  /// Calls `thought` while the arms are held; passes on what it throws.
  void think_about(const std::function<void()>& thought);

 private:
  void turn(LoopUnderTest::Turn (Probe::*what)(const std::array<ArmState, kMostArms>&,
                                               double) noexcept) noexcept;

  Ports ports_;
  Probe* probe_;
  Instant last_stamp_{};
  Instant next_{};
  double arm_seconds_ = 0.0;
};

}  // namespace teleop
