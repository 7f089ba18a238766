#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ports/peer.hpp"
#include "core/reporting/distribution.hpp"
#include "core/reporting/pairing.hpp"

namespace teleop {

struct Packets {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;

  Packets& operator+=(const Packets& other) noexcept;
};

/// A fault as it appeared.
struct FaultEvent {
  Role side = Role::master;
  double t_s = 0.0;  ///< since the run began
  int code = 0;
  std::string_view name;
  std::string_view cause;
};

/// A limit and how many turns it marked.
struct LimitCount {
  Role side = Role::master;
  std::uint64_t ticks = 0;
  int code = 0;
  std::string_view name;
  std::string_view cause;
};

/// A stretch without fresh packets from a peer that had been there.
struct Outage {
  Role side = Role::master;  ///< the side that heard nothing
  double t_s = 0.0;          ///< since the run began
  double length_s = 0.0;
  bool ended = false;  ///< false: it lasted to the end of the log
};

/// The raw values behind the distributions, kept so that two sides can be pooled exactly.
struct Samples {
  std::vector<double> lateness_us;    ///< every turn
  std::vector<double> compute_us;     ///< every turn
  std::vector<double> round_trip_us;  ///< every packet that told one
  std::vector<double> age_ms;         ///< every turn that used the peer's state (engaging, engaged)

  void append(const Samples& other);
};

[[nodiscard]] Samples samples_of(const Log& log);

/// What one log says about its side.
struct SideMetrics {
  Role role = Role::master;
  std::string file;
  std::string damage;       ///< of the recording, in words; empty when it is whole
  std::uint64_t ticks = 0;  ///< turns of the loop, recorded or not
  std::uint64_t dropped_records = 0;
  double begin_s = 0.0;           ///< first turn, since the run began
  double seconds = 0.0;           ///< from the first turn to the last
  double rate_Hz = 0.0;           ///< turns a second, mean
  double nominal_rate_Hz = 0.0;   ///< as configured
  double tick_share = 0.0;        ///< turns over those that fit into the time at the nominal rate
  double engaged_share = 0.0;     ///< of the recorded turns
  std::uint64_t engagements = 0;  ///< epochs in which the side was engaged
  std::uint64_t late_turns = 0;   ///< began later than a tenth of the period
  std::uint64_t overruns = 0;
  Distribution lateness_us;
  Distribution compute_us;
  Distribution round_trip_us;
  Distribution age_ms;
  Packets packets;
  double coupling_rms_N = 0.0;              ///< |coupling force at the tool|, engaged turns
  double coupling_peak_N = 0.0;             ///< all turns
  std::optional<double> tool_force_peak_N;  ///< hand or surroundings, where measured
  double coupling_energy_J = 0.0;           ///< that the coupling gave to the tool
  std::optional<double> port_energy_J;      ///< that hand or surroundings gave, where measured
  double law_error_rms_mm = 0.0;            ///< |e| as this side saw it, engaged turns
  double law_error_peak_mm = 0.0;
  std::vector<LimitCount> limits;
  std::vector<FaultEvent> faults;
  std::vector<Outage> outages;
};

/// @throws RecordingError when the log has no turn or does not say its role.
[[nodiscard]] SideMetrics side_metrics(const Side& side, const Samples& samples);

}  // namespace teleop
