#include "core/reporting/tables.hpp"

#include <functional>
#include <set>

#include <fmt/format.h>

#include "core/reporting/escape.hpp"

namespace teleop {
namespace {

constexpr const char* kNothing = "–";

/// 12345678 as 12 345 678, with narrow spaces that do not break.
std::string grouped(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (auto place = static_cast<std::ptrdiff_t>(text.size()) - 3; place > 0; place -= 3) {
    text.insert(static_cast<std::size_t>(place), "\u202f");
  }
  return text;
}

/// Four digits, no exponent for the numbers of a run.
std::string number(double value) {
  const double size = value < 0.0 ? -value : value;
  if (size >= 1000.0) return fmt::format("{:.0f}", value);
  if (size >= 100.0) return fmt::format("{:.1f}", value);
  if (size >= 1.0) return fmt::format("{:.2f}", value);
  return fmt::format("{:.3f}", value);
}

std::string figure(const std::string& label,
                   const std::string& value,
                   const std::string& unit,
                   const std::string& more) {
  return fmt::format(
      "<div class=\"figure\"><dt>{}</dt><dd><b>{}</b>{}</dd><dd class=\"more\">{}</dd></div>\n",
      label, value, unit.empty() ? "" : "&#8239;" + unit, more);
}

using Cell = std::function<std::string(const SideMetrics&)>;

/// Rows with a cell a side.
class Table {
 public:
  explicit Table(const PairMetrics& metrics) : metrics_{metrics} {
    out_ = "<table class=\"numbers\">\n<thead><tr><th></th>";
    for (const SideMetrics* side : metrics.sides()) {
      out_ += fmt::format("<th>{}</th>", name_of(side->role));
    }
    out_ += "</tr></thead>\n";
  }

  void group(const char* title) {
    out_ += fmt::format("<tr class=\"group\"><th colspan=\"3\">{}</th></tr>\n", title);
  }

  void row(const char* title, const Cell& cell) {
    out_ += fmt::format("<tr><th>{}</th>", title);
    for (const SideMetrics* side : metrics_.sides()) {
      out_ += fmt::format("<td>{}</td>", cell(*side));
    }
    out_ += "</tr>\n";
  }

  /// A figure of the pair, across both columns.
  void pair(const char* title, const std::string& text) {
    out_ += fmt::format("<tr><th>{}</th><td colspan=\"2\">{}</td></tr>\n", title, text);
  }

  void distribution(const char* title, Distribution SideMetrics::* member) {
    row(title, [member](const SideMetrics& side) {
      const Distribution& d = side.*member;
      if (d.count == 0) return std::string{kNothing};
      return fmt::format("{} / {} / {} / {} / {}", number(d.p50), number(d.p90), number(d.p99),
                         number(d.p999), number(d.max));
    });
  }

  [[nodiscard]] std::string text() const { return out_ + "</table>"; }

 private:
  const PairMetrics& metrics_;
  std::string out_;
};

std::string or_nothing(const std::optional<double>& value) {
  return value ? number(*value) : kNothing;
}

void add_pair(const PairMetrics& m, Table& table) {
  table.group("Pair");
  table.pair(
      "Tracking error, RMS / peak, mm",
      m.tracking ? number(m.tracking->rms_mm) + " / " + number(m.tracking->peak_mm) : kNothing);
  table.pair("Engaged together, s", m.tracking ? number(m.tracking->seconds) : kNothing);
  if (m.rest_contact) {
    table.pair("Hand over surroundings at rest", number(m.rest_contact->ratio));
  }
  if (m.clock_error_bound_us > 0.0) {
    table.pair("Clocks apart at most, µs", number(m.clock_error_bound_us));
  }
}

void add_motion(Table& table) {
  table.group("Motion and force");
  table.row("Position error as seen, RMS / peak, mm", [](const SideMetrics& s) {
    return number(s.law_error_rms_mm) + " / " + number(s.law_error_peak_mm);
  });
  table.row("Coupling force, RMS / peak, N", [](const SideMetrics& s) {
    return number(s.coupling_rms_N) + " / " + number(s.coupling_peak_N);
  });
  table.row("Force of hand or surroundings, peak, N",
            [](const SideMetrics& s) { return or_nothing(s.tool_force_peak_N); });
  table.row("Energy from the coupling, J",
            [](const SideMetrics& s) { return number(s.coupling_energy_J); });
  table.row("Energy from hand or surroundings, J",
            [](const SideMetrics& s) { return or_nothing(s.port_energy_J); });
}

void add_loop(Table& table) {
  table.group("Loop");
  table.row("Turns", [](const SideMetrics& s) { return grouped(s.ticks); });
  table.row("Rate, configured / done, Hz", [](const SideMetrics& s) {
    return number(s.nominal_rate_Hz) + " / " + number(s.rate_Hz);
  });
  table.row("Turns done of nominal, %",
            [](const SideMetrics& s) { return number(100.0 * s.tick_share); });
  table.row("Engaged, % / times", [](const SideMetrics& s) {
    return number(100.0 * s.engaged_share) + " / " + grouped(s.engagements);
  });
  table.row("Turns that ran past their period",
            [](const SideMetrics& s) { return grouped(s.overruns); });
  table.row("Turns late by more than a tenth",
            [](const SideMetrics& s) { return grouped(s.late_turns); });
  table.row("Turns missing in the log",
            [](const SideMetrics& s) { return grouped(s.dropped_records); });
}

void add_link(Table& table) {
  table.group("Link");
  table.row("Packets sent / received", [](const SideMetrics& s) {
    return grouped(s.packets.sent) + " / " + grouped(s.packets.received);
  });
  table.row("Lost / twice / out of order", [](const SideMetrics& s) {
    return grouped(s.packets.lost) + " / " + grouped(s.packets.duplicated) + " / " +
           grouped(s.packets.reordered);
  });
}

std::string value_cell(const std::string& value) {
  const bool long_text = value.find('\n') != std::string::npos;
  return long_text ? "<pre>" + escape_html(value) + "</pre>" : escape_html(value);
}

const std::string* find(const std::optional<Side>& side, const std::string& key) {
  if (!side) return nullptr;
  const auto entry = side->log->metadata.find(key);
  return entry == side->log->metadata.end() ? nullptr : &entry->second;
}

}  // namespace

std::string key_figures(const PairMetrics& m) {
  const SideMetrics& side = m.first();
  std::string out;
  const double rms = m.tracking ? m.tracking->rms_mm : side.law_error_rms_mm;
  const double peak = m.tracking ? m.tracking->peak_mm : side.law_error_peak_mm;
  const bool pair = m.master && m.slave;
  const bool engaged = m.engaged_share > 0.0;
  out += figure(pair ? "Tracking error" : "Error as seen", engaged ? number(rms) : kNothing,
                "mm RMS", engaged ? fmt::format("peak {} mm", number(peak)) : "never engaged");
  out += figure(fmt::format("Force at the {}", name_of(side.role)), number(side.coupling_rms_N),
                "N RMS", fmt::format("peak {} N", number(side.coupling_peak_N)));
  out += figure("Rate", fmt::format("{:.1f}", side.rate_Hz), "Hz",
                fmt::format("{:.2f} % of its turns", 100.0 * side.tick_share));
  const Distribution& trip = m.round_trip_us;
  out += figure("Round trip", trip.count > 0 ? number(trip.p50) : kNothing, "µs",
                trip.count > 0 ? fmt::format("99 % within {} µs", number(trip.p99)) : "unknown");
  out += figure("Lateness", number(m.lateness_us.p50), "µs",
                fmt::format("99 % within {} µs", number(m.lateness_us.p99)));
  out += figure("Packets lost", grouped(m.packets.lost), "",
                fmt::format("of {}", grouped(m.packets.received + m.packets.lost)));
  return out;
}

std::string number_table(const PairMetrics& metrics) {
  Table table{metrics};
  if (metrics.master && metrics.slave) add_pair(metrics, table);
  add_motion(table);
  add_loop(table);
  add_link(table);
  table.group("Times: 50 / 90 / 99 / 99.9 % within, largest");
  table.distribution("Lateness, µs", &SideMetrics::lateness_us);
  table.distribution("Compute, µs", &SideMetrics::compute_us);
  table.distribution("Round trip, µs", &SideMetrics::round_trip_us);
  table.distribution("Age of the peer's state, ms", &SideMetrics::age_ms);
  return table.text();
}

std::string metadata_table(const Run& run) {
  std::set<std::string> keys;
  for (const Side* side : run.sides()) {
    for (const auto& [key, value] : side->log->metadata) {
      keys.insert(key);
    }
  }
  const bool pair = run.master && run.slave;
  std::string out = "<table class=\"metadata\">\n";
  if (pair) out += "<thead><tr><th></th><th>master</th><th>slave</th></tr></thead>\n";
  for (const std::string& key : keys) {
    const std::string* m = find(run.master, key);
    const std::string* s = find(run.slave, key);
    out += fmt::format("<tr><th>{}</th>", escape_html(key));
    const auto cell = [](const std::string* value) {
      return value == nullptr ? std::string{kNothing} : value_cell(*value);
    };
    if (!pair || (m != nullptr && s != nullptr && *m == *s)) {
      out += fmt::format("<td colspan=\"2\">{}</td>", cell(m != nullptr ? m : s));
    } else {
      out += fmt::format("<td>{}</td><td>{}</td>", cell(m), cell(s));
    }
    out += "</tr>\n";
  }
  return out + "</table>";
}

}  // namespace teleop
