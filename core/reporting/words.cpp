#include "core/reporting/words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/fault.hpp"

namespace teleop {
namespace {

/// More rows of one kind than this are told as a number.
constexpr std::size_t kRowsTold = 5;
/// Energy below this is rounding and quantisation, not the law.
constexpr double kNoticeable = 1e-3;  // J
constexpr double kNominalShare = 0.99;
/// A silence as long as this has released the coupling; a shorter one is a remark.
constexpr double kReleased = 0.02;  // s

/// "1 turn", "2 turns".
std::string counted(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string time_text(double seconds) {
  if (seconds < 1.0) return fmt::format("{:.0f} ms", 1e3 * seconds);
  if (seconds < 120.0) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

/// Never "100 %" of what is not all, nor "0 %" of what is not nothing.
std::string percent(double share) {
  const double value = 100.0 * share;
  if (value <= 0.0) return "0 %";
  if (value >= 100.0) return "100 %";
  if (value > 99.9) return "more than 99.9 %";
  if (value < 0.01) return "less than 0.01 %";
  return fmt::format("{:.3g} %", value);
}

std::string other_than(Role role) {
  return name_of(role == Role::master ? Role::slave : Role::master);
}

std::string span_of(const PairMetrics& m) {
  const bool pair = m.master && m.slave;
  if (pair) {
    return fmt::format("The pair ran for {} at {:.0f} Hz", time_text(m.overlap_s),
                       m.first().rate_Hz);
  }
  return fmt::format("This is the {} alone; it ran for {} at {:.0f} Hz", name_of(m.first().role),
                     time_text(m.overlap_s), m.first().rate_Hz);
}

std::string tracking_of(const PairMetrics& m) {
  if (m.tracking) {
    return fmt::format(
        "While engaged the slave followed the master within {:.2f} mm RMS (peak {:.1f} mm).",
        m.tracking->rms_mm, m.tracking->peak_mm);
  }
  const SideMetrics& side = m.first();
  return fmt::format(
      "The position error that it saw, with the age of the {}'s data in it, was {:.2f} mm RMS "
      "(peak {:.1f} mm).",
      other_than(side.role), side.law_error_rms_mm, side.law_error_peak_mm);
}

std::string link_of(const PairMetrics& m) {
  const Packets& p = m.packets;
  if (p.received == 0) return "No packet arrived.";
  std::string text =
      p.lost == 0
          ? fmt::format("No packet was lost of {}", p.received + p.lost)
          : fmt::format(
                "{} of {} packets were lost ({})", p.lost, p.received + p.lost,
                percent(static_cast<double>(p.lost) / static_cast<double>(p.received + p.lost)));
  if (p.duplicated > 0) text += fmt::format(", {} came twice", p.duplicated);
  if (p.reordered > 0) text += fmt::format(", {} came out of order", p.reordered);
  if (m.round_trip_us.count > 0) {
    text += fmt::format("; half of the round trips took {:.0f} µs or less, 99 % {:.0f} µs or less",
                        m.round_trip_us.p50, m.round_trip_us.p99);
  }
  return text + ".";
}

std::string timing_of(const PairMetrics& m) {
  std::uint64_t late = 0;
  for (const SideMetrics* side : m.sides()) {
    late += side->late_turns;
  }
  const double limit_ms = 100.0 / std::max(m.first().nominal_rate_Hz, 1e-9);
  const std::string how_many =
      late == 0 ? fmt::format("No turn began more than {:.3g} ms late", limit_ms)
                : fmt::format("{} began more than {:.3g} ms late", counted(late, "turn"), limit_ms);
  return fmt::format("{}: 99 % within {:.0f} µs, the worst {:.0f} µs.", how_many, m.lateness_us.p99,
                     m.lateness_us.max);
}

std::vector<std::string> story_of(const PairMetrics& m) {
  std::vector<std::string> story;
  const bool engaged = m.engaged_share > 0.0;
  story.push_back(span_of(m) +
                  (engaged ? fmt::format(" and was engaged for {} of it.", percent(m.engaged_share))
                           : std::string{"."}));
  if (engaged) {
    story.push_back(tracking_of(m));
    story.push_back(
        fmt::format("The coupling pulled at the {}'s tool with {:.2f} N RMS (peak {:.1f} N).",
                    name_of(m.first().role), m.first().coupling_rms_N, m.first().coupling_peak_N));
  }
  if (m.rest_contact) {
    const RestContact& c = *m.rest_contact;
    story.push_back(
        fmt::format("Pressing at rest for {}, the hand held {:.2f} times the force of the "
                    "surroundings ({:.2f} N against {:.2f} N).",
                    time_text(c.seconds), c.ratio, c.hand_force_N, c.wall_force_N));
  }
  story.push_back(link_of(m));
  story.push_back(timing_of(m));
  return story;
}

/// Tells the first rows, and how many more there are.
template <class Row, class Text>
void tell(const std::vector<Row>& rows, std::string_view noun, Text&& text, Words& words) {
  const std::size_t told = std::min(rows.size(), kRowsTold);
  for (std::size_t i = 0; i < told; ++i) {
    words.troubles.push_back(text(rows[i]));
  }
  if (rows.size() > told) {
    words.troubles.push_back(fmt::format("And {} more.", counted(rows.size() - told, noun)));
  }
}

std::string fault_text(const FaultEvent& fault) {
  return fmt::format("At {:.2f} s the {} reported fault {} ({}): {}.", fault.t_s,
                     name_of(fault.side), fault.code, fault.name, fault.cause);
}

std::string outage_text(const Outage& outage) {
  return fmt::format("From {:.2f} s the {} heard nothing from the {} for {}{}.", outage.t_s,
                     name_of(outage.side), other_than(outage.side), time_text(outage.length_s),
                     outage.ended ? "" : ", and it did not return");
}

void tell_side(const SideMetrics& side, Words& words) {
  const std::string who = name_of(side.role);
  if (side.tick_share < kNominalShare) {
    words.troubles.push_back(fmt::format("The {} did only {} of the turns that {:.0f} Hz ask for.",
                                         who, percent(side.tick_share), side.nominal_rate_Hz));
  }
  for (const LimitCount& limit : side.limits) {
    // Outages tell the silence, the figures below the overruns and the records.
    const bool told_elsewhere = limit.name == name_of(Limit::peer_silent) ||
                                limit.name == name_of(Limit::overrun) ||
                                limit.name == name_of(Limit::record_dropped);
    if (told_elsewhere) continue;
    words.troubles.push_back(
        fmt::format("On {} of the {}: {}.", counted(limit.ticks, "turn"), who, limit.cause));
  }
  if (side.overruns > 0) {
    words.troubles.push_back(fmt::format("{} of the {} ran past {} period.",
                                         counted(side.overruns, "turn"), who,
                                         side.overruns == 1 ? "its" : "their"));
  }
  if (side.dropped_records > 0) {
    words.troubles.push_back(fmt::format("The log of the {} lacks {} that the recording dropped.",
                                         who, counted(side.dropped_records, "turn")));
  }
  if (!side.damage.empty()) {
    words.troubles.push_back(fmt::format("The log of the {} is not whole: {}.", who, side.damage));
  }
}

void tell_pair(const PairMetrics& m, Words& words) {
  if (m.clocks_unknown) {
    words.troubles.emplace_back(
        "The two machines never heard each other, so their times cannot be compared.");
  } else if (m.overlap_s <= 0.0) {
    words.troubles.emplace_back(
        "The two logs do not overlap in time; they may be of different runs.");
  }
  double net = 0.0;
  for (const SideMetrics* side : m.sides()) {
    net += side->coupling_energy_J;
  }
  if (net > kNoticeable) {
    words.troubles.push_back(fmt::format(
        "The coupling gave {:.3g} J more to the tools than it took from them: it was not passive.",
        net));
  }
}

std::string headline_of(const PairMetrics& m, const Words& words) {
  const bool faulted = std::any_of(m.faults.begin(), m.faults.end(), [](const FaultEvent& fault) {
    return fault.code < static_cast<int>(Fault::recording_failed);
  });
  if (faulted) return "A fault ended the coupling";
  const bool lost = std::any_of(m.outages.begin(), m.outages.end(),
                                [](const Outage& outage) { return !outage.ended; });
  if (lost) return "The link was lost and did not return";
  if (m.engaged_share <= 0.0) {
    return m.master && m.slave ? "The two sides were never engaged together"
                               : "This side was never engaged";
  }
  const bool long_lost = std::any_of(m.outages.begin(), m.outages.end(), [](const Outage& outage) {
    return outage.length_s > kReleased;
  });
  if (long_lost) return "The link was lost and came back";
  return words.troubles.empty() ? "A clean run" : "A run with remarks";
}

}  // namespace

Words describe(const PairMetrics& metrics) {
  Words words;
  words.story = story_of(metrics);
  tell(metrics.faults, "fault", fault_text, words);
  tell(metrics.outages, "outage", outage_text, words);
  for (const SideMetrics* side : metrics.sides()) {
    tell_side(*side, words);
  }
  if (metrics.sides().size() == 2) tell_pair(metrics, words);
  words.headline = headline_of(metrics, words);
  return words;
}

}  // namespace teleop
