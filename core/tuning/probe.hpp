#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/ports/arm.hpp"
#include "core/realtime/loop.hpp"
#include "core/tuning/loop_under_test.hpp"

namespace teleop {

/// What no probe may exceed. A probe is stopped at kStopShare of each, so that what happens until
/// the stop takes effect stays within. Travel stays within as far as the safe law can brake what
/// the bound on speed lets through.
struct ProbeBounds {
  double speed_m_per_s = 1.0;  ///< of each tool along the axis
  double force_N = 8.0;        ///< commanded along the axis; more is cut, so never exceeded
  double travel_m = 0.010;     ///< from the pose, along the axis
  double energy_J = 0.5;       ///< that the motors put in, in one probe
};
inline constexpr double kStopShare = 0.6;
inline constexpr double kFloorShare = 0.35;

/// Why the watch of a probe ended. Numbers are part of the journal.
enum class ProbeStop : std::uint8_t {
  time = 0,     ///< watched as long as planned
  decayed = 1,  ///< the motion fell below the floor
  grew = 2,     ///< it passed the ceiling
  speed = 3,    ///< a bound, like the next three
  force = 4,
  travel = 5,
  energy = 6,
  fault = 7,      ///< the device reported a fault or a number that is none
  restless = 8,   ///< not at rest before the push
  abandoned = 9,  ///< told to stop
};
[[nodiscard]] std::string_view name_of(ProbeStop stop) noexcept;
[[nodiscard]] constexpr bool is_bound(ProbeStop stop) noexcept {
  return stop >= ProbeStop::speed && stop <= ProbeStop::energy;
}

/// One push at one gain.
struct ProbePlan {
  double gain = 0.0;
  double safe_gain = 0.0;  ///< that motion is known to die under
  double push_N = 0.0;
  int push_ticks = 1;
  double watch_s = 1.0;
  double period_s = 0.05;     ///< expected; amplitudes are half the peak to peak over one
  double memory_s = 0.02;     ///< of the law: what is small for so long stays small
  double amplitude_m = 3e-4;  ///< A: the growth at this amplitude is asked for
  double ceiling_m = 1e-3;    ///< amplitude at which the watch ends
  double floor_m = 1e-4;      ///< and at which it ends, or kFloorShare of the largest so far
};

/// What the loop itself knows of a probe; the rest is for the analysis of its trace.
struct ProbeOutcome {
  ProbeStop stop = ProbeStop::time;
  bool rests = false;    ///< at the end, verified
  int fallbacks = 0;     ///< 1: it took zero gain to come to rest; 2: and no weak loop either
  bool swelled = false;  ///< because the motion grew under the safe gain
  int ticks = 0;         ///< of the whole probe
  int watch_ticks = 0;
  double peak_swing_m = 0.0;  ///< largest amplitude during the watch
  int ticks_to_safe = 0;     ///< from the reading that broke a bound to the safe gain's first force
  double rest_peak_m = 0.0;  ///< half the peak to peak while resting
  double peak_speed_m_per_s = 0.0;
  double peak_force_N = 0.0;
  double peak_travel_m = 0.0;
  double energy_J = 0.0;
};

/// The motion of a probe from the end of its push to the end of its watch. Memory of a fixed size.
struct ProbeTrace {
  std::vector<double> t_s;
  std::array<std::vector<Vector3>, kMostArms> displacement;
  std::size_t size = 0;
};

/// One probe: waits for rest under the safe gain, sets the gain, pushes, watches, goes back to the
/// safe gain and waits for rest again:
///
///     settle → push → watch → recover → done
///
/// Should the motion swell under the safe gain, or not die within kPatience_s, the gain becomes
/// zero; should it swell then, the weak loop on the axis is left out as well.
///
/// Every tick looks at the bounds first: the tick whose reading breaks one already computes its
/// force with the safe gain. At rest: for kRest_s no tool moved along the axis by more than three
/// counts. While it settles and recovers the weak loop holds the axis too.
///
/// Thread: the loop's only. Loop: begin, step and idle are allocation-free, noexcept and bounded.
class Probe {
 public:
  struct Config {
    ProbeBounds bounds{};
    double period_s = 1e-3;
    double longest_watch_s = 5.0;
    double longest_rest_s = 8.0;  ///< until then it must be at rest
  };

  Probe(const Config& config, LoopUnderTest& loop);

  void begin(const ProbePlan& plan) noexcept;

  /// @returns what to write to each arm. done() tells whether the probe has ended.
  LoopUnderTest::Turn step(const std::array<ArmState, kMostArms>& arms, double dt) noexcept;

  /// The law that keeps an arm where it is between probes.
  LoopUnderTest::Turn idle(const std::array<ArmState, kMostArms>& arms, double dt) noexcept;

  void abandon() noexcept { abandoned_ = true; }

  [[nodiscard]] bool done() const noexcept { return phase_ == Phase::done; }
  [[nodiscard]] const ProbeOutcome& outcome() const noexcept { return outcome_; }
  [[nodiscard]] const ProbeTrace& trace() const noexcept { return trace_; }
  [[nodiscard]] const ProbeBounds& bounds() const noexcept { return config_.bounds; }

  static constexpr double kRest_s = 0.06;
  static constexpr double kLongestRest_s = 0.25;
  static constexpr double kPatience_s = 3.0;

 private:
  enum class Phase : std::uint8_t { settle, push, watch, recover, done };
  static constexpr std::size_t kWindow = 128;

  void measure(const LoopUnderTest::Turn& turn, double dt) noexcept;
  void look_at_bounds(const std::array<ArmState, kMostArms>& arms, double dt) noexcept;
  void remember(const LoopUnderTest::Turn& turn) noexcept;
  void go(Phase next) noexcept;
  void end_watch(ProbeStop stop, int ticks_to_safe) noexcept;
  void advance(const LoopUnderTest::Turn& turn) noexcept;
  void advance_watch(const LoopUnderTest::Turn& turn) noexcept;
  void fall_back() noexcept;
  [[nodiscard]] double rest_window_s() const noexcept;
  [[nodiscard]] LoopUnderTest::Command command() const noexcept;
  [[nodiscard]] double amplitude(std::size_t window) const noexcept;
  [[nodiscard]] bool rests() noexcept;
  [[nodiscard]] bool is_near() const noexcept;

  Config config_;
  LoopUnderTest* loop_;
  Eigen::Index axis_;
  ProbePlan plan_{};
  ProbeOutcome outcome_{};
  ProbeTrace trace_{};
  Phase phase_ = Phase::done;
  bool abandoned_ = false;
  int in_phase_ = 0;  ///< ticks
  int on_level_ = 0;  ///< ticks since the last fallback
  int small_for_ = 0;
  double time_s_ = 0.0;
  double work_J_ = 0.0;
  std::array<double, kMostArms> last_x_{};
  std::array<double, kMostArms> last_force_{};
  bool has_last_ = false;

  // Recent positions along the axis, thinned so that kWindow of them cover a period or the rest.
  std::array<std::array<double, kWindow>, kMostArms> recent_{};
  std::size_t newest_ = 0;
  std::size_t filled_ = 0;
  int stride_ = 1;
  int since_kept_ = 0;
};

}  // namespace teleop
