#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/concealed/effect.hpp"
#include "scenarios/concealed/excitation.hpp"
#include "scenarios/concealed/law.hpp"

namespace teleop::concealed {

inline constexpr std::size_t kRuns = 6;  ///< the last one is held back
inline constexpr double kCommandStep_Nm = 1e-5;

/// What shakes every device, an axis each.
struct Disturbance {
  JointVector white_Nm = JointVector::Zero();     ///< RMS of its mean over a sample
  JointVector coloured_Nm = JointVector::Zero();  ///< RMS
  JointVector coloured_time_s = JointVector::Constant(0.03);
  JointVector narrow_Nm = JointVector::Zero();  ///< RMS of a narrow band
  double narrow_Hz = 10.0;
  double encoder_noise_counts = 0.0;  ///< RMS
};

/// Position loop of one axis: u = k_p (r − y) + k_d (ṙ − v̂) + share · inertia r̈ + N(y) + extra,
/// with v̂ the low-passed difference of readings. `friction_feed_forward` · tanh(ṙ / 0.05 rad/s) is
/// added.
struct AxisController {
  double stiffness = 0.0;              ///< N m/rad
  double damping = 0.0;                ///< N m s/rad
  double bandwidth_Hz = 80.0;          ///< of v̂
  double inertia = 0.0;                ///< kg m², of the feed-forward
  double friction_feed_forward = 0.0;  ///< N m
};

struct RunPlan {
  Excitation excitation{};
  std::array<AxisController, kJoints> control{};
  JointVector q = JointVector::Zero();  ///< at the start
  JointVector v = JointVector::Zero();
  std::uint64_t seed = 0;
};

/// A device with all that happens to it in its runs.
struct Device {
  ArmModel arm;      ///< as it is: its inertias are off
  ArmModel nominal;  ///< as the recordings' reader believes it
  std::vector<Effect> effects{};
  Disturbance disturbance{};
  std::array<RunPlan, kRuns> runs{};
  int substeps = 40;  ///< of a sample period
};

/// Row k: the reading at t_k and the command that was computed from it.
struct Run {
  std::string excitation{};
  std::vector<std::array<std::int32_t, kJoints>> counts{};
  std::vector<JointVector> logged{};   ///< N m, of the log
  std::vector<JointVector> applied{};  ///< N m; other than logged on one sort of stranger
  std::vector<double> late{};          ///< s; empty: no stamp is late
  JointVector largest_departure = JointVector::Zero();  ///< of links from the middle posture, rad
  double largest_speed = 0.0;                           ///< rad/s
  JointVector chatter = JointVector::Zero();            ///< RMS of the commands' steps, N m

  /// Within the workspace, and no loop that the effects have made rattle: its commands step no more
  /// than a few times as far as those of `calm`, the same run without effects.
  [[nodiscard]] bool usable(const Run& calm) const noexcept;
};

/// The angle of one count, rad.
[[nodiscard]] JointVector count_rad(const ArmModel& arm);

/// The laws of one run: effects that are there, instants of catches and slips.
[[nodiscard]] PlantLaw law_of(const Device& device, std::size_t run);

/// Slips that an encoder has made until then, in counts.
[[nodiscard]] double slipped_counts(const ReadingLaw& law, double t) noexcept;

/// The closed loop over one run.
[[nodiscard]] Run simulate(const Device& device, std::size_t run, int substeps);

}  // namespace teleop::concealed
