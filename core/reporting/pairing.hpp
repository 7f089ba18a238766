#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/math/spatial.hpp"
#include "core/reporting/run_clock.hpp"

namespace teleop {

/// How the law maps the master's motion to the slave: scale s and rotation R from the master's
/// base to the slave's. Metadata "law_scale" (a number) and "law_rotation" (nine numbers, row by
/// row, separated by spaces or commas); identity where they are missing.
struct LawGeometry {
  double scale = 1.0;
  Matrix3 R_SM = Matrix3::Identity();
};

/// @throws RecordingError when one of them is there and is not such numbers.
[[nodiscard]] LawGeometry law_geometry(const Log& log);

/// Master and slave at one instant, the master's stamp, in an engagement of both.
struct PairedTick {
  std::size_t master = 0;           ///< index of the master's record
  std::size_t slave = 0;            ///< index of the slave's record at or before it
  double t_s = 0.0;                 ///< since the run began
  Vector3 error = Vector3::Zero();  ///< e, m, in the slave's base
};

/// A side's log on the time axis of the run.
struct Side {
  const Log* log = nullptr;
  RunClock clock{};
};

/// The tracking error of the two plants at equal times,
///
///     e = s R (x_m − x_m0) − (x_s − x_s0)
///
/// at every master stamp at which both sides are engaged in the same epoch. The slave is
/// interpolated linearly between its two records around that stamp (at 1 kHz and 20 m/s² that is
/// 3 µm off at most); where they are more than five turns apart, records are missing and so is e.
[[nodiscard]] std::vector<PairedTick> pair_ticks(const Side& master, const Side& slave);

/// What the hand feels of the wall when nothing moves: there the ratio of the two contact forces is
/// free of inertia, friction aside.
struct RestContact {
  double seconds = 0.0;       ///< how long both tools rested in contact
  double hand_force_N = 0.0;  ///< mean |force of the hand on the master's tool|
  double wall_force_N = 0.0;  ///< mean |force of the surroundings on the slave's tool|
  double ratio = 0.0;         ///< hand over wall
};

/// Over whole windows of 0.1 s in which each tool keeps within 0.25 mm on every axis and the mean
/// force at the slave's tool exceeds 0.2 N. Absent when there is no such window or an arm does not
/// measure its tool force.
[[nodiscard]] std::optional<RestContact> contact_at_rest(const Log& master,
                                                         const Log& slave,
                                                         std::span<const PairedTick> pairs);

}  // namespace teleop
