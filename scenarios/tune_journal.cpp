#include "scenarios/tune_journal.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"

namespace teleop {
namespace {

using nlohmann::json;

json to_json(const Oscillation& o) {
  return {{"growth_per_s", o.growth_per_s},
          {"growth_std_per_s", o.growth_std_per_s},
          {"frequency_Hz", o.frequency_Hz},
          {"frequency_std_Hz", o.frequency_std_Hz},
          {"amplitude_start_m", o.amplitude_start},
          {"amplitude_end_m", o.amplitude_end},
          {"amplitude_here_m", o.amplitude_here},
          {"residual_std_m", o.residual_std},
          {"modes", o.modes}};
}

Oscillation oscillation_from(const json& j) {
  return {.growth_per_s = j.at("growth_per_s"),
          .growth_std_per_s = j.at("growth_std_per_s"),
          .frequency_Hz = j.at("frequency_Hz"),
          .frequency_std_Hz = j.at("frequency_std_Hz"),
          .amplitude_start = j.at("amplitude_start_m"),
          .amplitude_end = j.at("amplitude_end_m"),
          .amplitude_here = j.at("amplitude_here_m"),
          .residual_std = j.at("residual_std_m"),
          .modes = j.at("modes")};
}

}  // namespace

json to_json(const ProbeResult& p) {
  json shape = json::array();
  for (const ShapeEntry& e : p.shape) {
    shape.push_back(
        {{"arm", e.arm}, {"axis", e.axis}, {"ratio", e.ratio}, {"phase_rad", e.phase_rad}});
  }
  json others = json::array();
  for (const Oscillation& o : p.others) {
    others.push_back(to_json(o));
  }
  json j{{"gain", p.plan.gain},
         {"safe_gain", p.plan.safe_gain},
         {"push_N", p.plan.push_N},
         {"push_ticks", p.plan.push_ticks},
         {"watch_s", p.plan.watch_s},
         {"amplitude_m", p.plan.amplitude_m},
         {"verdict", name_of(p.verdict)},
         {"verdict_code", static_cast<int>(p.verdict)},
         {"stop", name_of(p.outcome.stop)},
         {"stop_code", static_cast<int>(p.outcome.stop)},
         {"rests", p.outcome.rests},
         {"fallbacks", p.outcome.fallbacks},
         {"swelled", p.outcome.swelled},
         {"ticks", p.outcome.ticks},
         {"watch_ticks", p.outcome.watch_ticks},
         {"ticks_to_safe", p.outcome.ticks_to_safe},
         {"peak_swing_m", p.outcome.peak_swing_m},
         {"rest_peak_m", p.outcome.rest_peak_m},
         {"peak_speed_m_per_s", p.outcome.peak_speed_m_per_s},
         {"peak_force_N", p.outcome.peak_force_N},
         {"peak_travel_m", p.outcome.peak_travel_m},
         {"energy_J", p.outcome.energy_J},
         {"missed_turns", p.timing.missed_turns},
         {"arm_seconds", p.timing.arm_seconds},
         {"shape", shape},
         {"others", others}};
  if (p.oscillation) j["oscillation"] = to_json(*p.oscillation);
  return j;
}

ProbeResult probe_from_json(const json& j) {
  ProbeResult p;
  p.plan.gain = j.at("gain");
  p.plan.safe_gain = j.at("safe_gain");
  p.plan.push_N = j.at("push_N");
  p.plan.push_ticks = j.at("push_ticks");
  p.plan.watch_s = j.at("watch_s");
  p.plan.amplitude_m = j.at("amplitude_m");
  p.verdict = static_cast<Verdict>(j.at("verdict_code").get<int>());
  p.outcome = {.stop = static_cast<ProbeStop>(j.at("stop_code").get<int>()),
               .rests = j.at("rests"),
               .fallbacks = j.at("fallbacks"),
               .swelled = j.at("swelled"),
               .ticks = j.at("ticks"),
               .watch_ticks = j.at("watch_ticks"),
               .peak_swing_m = j.at("peak_swing_m"),
               .ticks_to_safe = j.at("ticks_to_safe"),
               .rest_peak_m = j.at("rest_peak_m"),
               .peak_speed_m_per_s = j.at("peak_speed_m_per_s"),
               .peak_force_N = j.at("peak_force_N"),
               .peak_travel_m = j.at("peak_travel_m"),
               .energy_J = j.at("energy_J")};
  p.timing = {.missed_turns = j.at("missed_turns"), .arm_seconds = j.at("arm_seconds")};
  for (const json& e : j.at("shape")) {
    p.shape.push_back({.arm = e.at("arm"),
                       .axis = e.at("axis"),
                       .ratio = e.at("ratio"),
                       .phase_rad = e.at("phase_rad")});
  }
  for (const json& o : j.at("others")) {
    p.others.push_back(oscillation_from(o));
  }
  if (j.contains("oscillation")) p.oscillation = oscillation_from(j.at("oscillation"));
  return p;
}

TuneJournal::TuneJournal(const std::filesystem::path& file, const json& asked, bool resume) {
  jobs_.resize(asked.at("jobs").size());
  const bool goes_on = resume && std::filesystem::exists(file);
  if (goes_on) load(file, asked);
  out_.open(file, goes_on ? std::ios::app : std::ios::trunc);
  if (!goes_on) out_ << asked.dump() << '\n' << std::flush;
  if (!out_) throw ConfigError{fmt::format("{}: cannot be written", file.string())};
}

void TuneJournal::load(const std::filesystem::path& file, const json& asked) {
  std::uintmax_t whole = 0;  // bytes of complete lines
  {
    std::ifstream in{file};
    std::string line;
    bool is_first = true;
    while (std::getline(in, line) && !in.eof()) {
      const json j = json::parse(line, nullptr, false);
      const bool fits = !j.is_discarded() && (is_first ? j == asked : j.contains("probe"));
      if (!fits && is_first) {
        throw ConfigError{fmt::format(
            "{}: is the journal of another run; take another --out or leave out --resume",
            file.string())};
      }
      if (!fits) break;
      if (!is_first) jobs_.at(j.at("job")).push_back(probe_from_json(j.at("probe")));
      is_first = false;
      whole += line.size() + 1;
    }
  }
  // A line that a kill cut short is dropped.
  std::filesystem::resize_file(file, whole);
}

const std::vector<ProbeResult>& TuneJournal::done(std::size_t job) const { return jobs_.at(job); }

void TuneJournal::append(std::size_t job, const ProbeResult& probe) {
  out_ << json{{"job", job}, {"probe", to_json(probe)}}.dump() << '\n' << std::flush;
}

}  // namespace teleop
