#include "scenarios/summary.hpp"

#include <fmt/format.h>

#include "core/reporting/words.hpp"

namespace teleop {
namespace {

std::string row(std::string_view name, const std::string& value) {
  return fmt::format("  {:<14} {}\n", name, value);
}

std::string percentiles(const Distribution& d, std::string_view unit) {
  if (d.count == 0) return "not measured";
  return fmt::format("p50 {:.4g}  p99 {:.4g}  p99.9 {:.4g}  max {:.4g} {}", d.p50, d.p99, d.p999,
                     d.max, unit);
}

}  // namespace

std::string summary_text(const PairMetrics& metrics,
                         const std::vector<std::filesystem::path>& files) {
  const Words words = describe(metrics);
  std::string text = words.headline + "\n";
  for (const auto& side : {metrics.master, metrics.slave}) {
    if (!side) continue;
    text += row(name_of(side->role),
                fmt::format("{} turns at {:.1f} Hz, {:.2f} % of nominal, {} overran", side->ticks,
                            side->rate_Hz, 1e2 * side->tick_share, side->overruns));
  }
  if (metrics.tracking) {
    text += row("tracking", fmt::format("{:.3f} mm RMS, {:.3f} mm peak, over {:.1f} s engaged",
                                        metrics.tracking->rms_mm, metrics.tracking->peak_mm,
                                        metrics.tracking->seconds));
  }
  text += row("force", fmt::format("{:.3f} N RMS, {:.3f} N peak", metrics.first().coupling_rms_N,
                                   metrics.first().coupling_peak_N));
  if (metrics.rest_contact) {
    text += row("contact", fmt::format("hand over wall {:.3f}, at rest for {:.1f} s",
                                       metrics.rest_contact->ratio, metrics.rest_contact->seconds));
  }
  text += row("round trip", percentiles(metrics.round_trip_us, "us"));
  text += row("age", percentiles(metrics.age_ms, "ms"));
  text += row("lateness", percentiles(metrics.lateness_us, "us"));
  text += row("compute", percentiles(metrics.compute_us, "us"));
  text += row("packets",
              fmt::format("{} sent, {} received, {} lost, {} duplicated, {} reordered",
                          metrics.packets.sent, metrics.packets.received, metrics.packets.lost,
                          metrics.packets.duplicated, metrics.packets.reordered));
  for (const std::string& trouble : words.troubles) {
    text += "  ! " + trouble + "\n";
  }
  for (const std::filesystem::path& file : files) {
    text += row("written", file.string());
  }
  return text;
}

}  // namespace teleop
