#pragma once

#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/reporting/side_metrics.hpp"

namespace teleop {

/// The logs of one run put on one time axis. Refers to the logs: they must outlive it.
struct Run {
  std::optional<Side> master;
  std::optional<Side> slave;
  double seconds = 0.0;  ///< from the first turn of either side to the last

  [[nodiscard]] std::vector<const Side*> sides() const;  ///< that are there, master first
};

/// @throws RecordingError: no log or more than two, two of one side, a log without turns or role.
[[nodiscard]] Run arrange(std::span<const Log> logs);

/// |e| over the turns at which both sides were engaged in the same epoch.
struct Tracking {
  double rms_mm = 0.0;
  double peak_mm = 0.0;
  double seconds = 0.0;  ///< engaged together
};

/// The figures of a run, one side or both. What needs both is absent in a run of one.
struct PairMetrics {
  std::optional<SideMetrics> master;
  std::optional<SideMetrics> slave;
  std::optional<Tracking> tracking;
  std::optional<RestContact> rest_contact;
  double seconds = 0.0;
  double overlap_s = 0.0;             ///< both sides ran; of one side, its whole log
  double engaged_share = 0.0;         ///< of the overlap, both engaged together; else the side's
  double clock_error_bound_us = 0.0;  ///< between two machines
  bool clocks_unknown = false;        ///< two machines that never heard each other
  Distribution lateness_us;           ///< this and the next three: both sides pooled
  Distribution compute_us;
  Distribution round_trip_us;
  Distribution age_ms;
  Packets packets;  ///< both directions together
  std::vector<FaultEvent> faults;
  std::vector<Outage> outages;
  std::vector<LimitCount> limits;

  [[nodiscard]] std::vector<const SideMetrics*> sides() const;  ///< that are there, master first

  /// The master's, or that of the only side.
  /// @pre there is one.
  [[nodiscard]] const SideMetrics& first() const;
};

/// @throws RecordingError as arrange(), and for metadata of the law that are no numbers.
[[nodiscard]] PairMetrics measure(std::span<const Log> logs);

/// Under the names that scripts rely on; what is absent is null.
[[nodiscard]] nlohmann::json to_json(const PairMetrics& metrics);

}  // namespace teleop
