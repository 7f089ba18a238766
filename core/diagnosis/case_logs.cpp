#include "core/diagnosis/case_logs.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/model/arm_model.hpp"
#include "core/model/kinematics.hpp"
#include "core/ports/arm.hpp"
#include "core/ports/peer.hpp"

namespace teleop {
namespace {

bool has(const TickRecord& tick, ArmFlag flag) noexcept {
  return (tick.arm_flags & static_cast<std::uint32_t>(flag)) != 0;
}

const std::string& said(const Log& log, const std::string& key) {
  const auto entry = log.metadata.find(key);
  if (entry == log.metadata.end() || entry->second.empty()) {
    throw ConfigError{
        fmt::format("{}: does not say '{}' in its metadata; give a log that "
                    "teleop-master or teleop-slave wrote",
                    log.file.string(), key)};
  }
  return entry->second;
}

double period_of(const Log& log) {
  const std::string& text = said(log, "rate_Hz");
  double rate_Hz = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate_Hz);
  if (error != std::errc{} || !std::isfinite(rate_Hz) || rate_Hz <= 0.0) {
    throw ConfigError{
        fmt::format("{}: rate_Hz = '{}' is no rate; repair its metadata", log.file.string(), text)};
  }
  return std::floor(1e9 / rate_Hz) / 1e9;  // as the loop has it
}

JointVector resolution_of(const ArmModel& arm) {
  const auto& counts = arm.parameters().encoder_counts_per_rev;
  return 2.0 * std::numbers::pi * JointVector{1.0 / counts[0], 1.0 / counts[1], 1.0 / counts[2]};
}

double seconds_into(const Log& log, const TickRecord& tick) noexcept {
  return 1e-9 * static_cast<double>(tick.stamp_ns - log.ticks.front().stamp_ns);
}

/// Ticks [first, last) of a log that one run holds.
struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Cuts a log wherever a turn is off the grid of the ones before it or gives no usable row.
class Stretches {
 public:
  Stretches(const Log& log, double period_s) : log_{log}, period_s_{period_s} {
    for (std::size_t k = 0; k < usable_end(); ++k) {
      visit(k);
    }
    close(usable_end());
  }

  [[nodiscard]] const std::vector<Stretch>& list() const noexcept { return list_; }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> lines;
    const auto tell = [&](std::size_t number, const std::string& text) {
      if (number > 0) lines.push_back(text);
    };
    tell(gaps_,
         fmt::format("{} time(s) turns came late or were lost, first at record {}: a new run "
                     "begins there",
                     gaps_, first_gap_ + 1));
    tell(dropped_, fmt::format("{} turn(s) in which the device had dropped its torque or read no "
                               "number are left out",
                               dropped_));
    tell(short_,
         fmt::format("{} stretch(es) shorter than {} s are left out", short_, kShortestRun_s));
    if (!log_.complete) lines.push_back("the log is damaged: " + log_.damage);
    return lines;
  }

 private:
  /// The last record tells of the stop and repeats the reading before it.
  [[nodiscard]] std::size_t usable_end() const noexcept {
    const auto& ticks = log_.ticks;
    const bool stopped = !ticks.empty() && ticks.back().tau_Nm.isZero(0.0) &&
                         ticks.back().mode == static_cast<std::uint32_t>(Mode::idle);
    return ticks.size() - (stopped ? 1 : 0);
  }

  void visit(std::size_t k) {
    const TickRecord& tick = log_.ticks[k];
    const bool sound =
        tick.q_rad.allFinite() && tick.tau_Nm.allFinite() && !has(tick, ArmFlag::watchdog_tripped);
    const bool usable = sound && has(tick, ArmFlag::amplifiers_on);
    if (!sound) ++dropped_;
    if (!usable) {
      close(k);
      return;
    }
    if (open_ && off_grid(k)) {
      if (gaps_++ == 0) first_gap_ = k;
      close(k);
    }
    if (!open_) begin_ = k;
    open_ = true;
  }

  [[nodiscard]] bool off_grid(std::size_t k) const noexcept {
    const double due = static_cast<double>(k - begin_) * period_s_;
    const double at = seconds_into(log_, log_.ticks[k]) - seconds_into(log_, log_.ticks[begin_]);
    return std::abs(at - due) > 0.5 * period_s_;
  }

  void close(std::size_t end) {
    if (!open_) return;
    open_ = false;
    if (static_cast<double>(end - begin_) * period_s_ < kShortestRun_s) {
      ++short_;
    } else {
      list_.push_back({.first = begin_, .last = end});
    }
  }

  const Log& log_;
  double period_s_;
  std::vector<Stretch> list_{};
  bool open_ = false;
  std::size_t begin_ = 0;
  std::size_t gaps_ = 0;
  std::size_t first_gap_ = 0;
  std::size_t dropped_ = 0;
  std::size_t short_ = 0;
};

/// Counts are whole, so angles of this arm are counts times its resolution up to the rounding of a
/// homing offset, which is whole too.
void check_counts(const Log& log, const ArmModel& arm) {
  const JointVector resolution = resolution_of(arm);
  for (std::size_t k = 0; k < log.ticks.size(); ++k) {
    const TickRecord& tick = log.ticks[k];
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double counts = tick.q_rad[axis] / resolution[axis];
      if (!std::isfinite(counts) || std::abs(counts - std::round(counts)) < 1e-3) continue;
      throw ConfigError{fmt::format(
          "{}: record {}: q_rad[{}] = {} is {:.3f} counts of arm '{}', not "
          "a whole number: the log is of another arm",
          log.file.string(), k + 1, i, tick.q_rad[axis], counts, arm.parameters().name)};
    }
  }
}

Recording run_of(const Log& log, const Stretch& stretch, const ArmModel& arm) {
  const auto& p = arm.parameters();
  const std::size_t rows = stretch.last - stretch.first;
  const auto begin = log.ticks.begin() + static_cast<std::ptrdiff_t>(stretch.first);
  const auto end = begin + static_cast<std::ptrdiff_t>(rows);
  const auto always = [&](ArmFlag flag) {
    return std::all_of(begin, end, [&](const TickRecord& tick) { return has(tick, flag); });
  };
  const bool touched = always(ArmFlag::has_tool_force);
  const bool measured = always(ArmFlag::has_currents);
  Recording run{.name = log.file.filename().string()};
  run.file = log.file.string();
  run.first_row = stretch.first + 1;
  run.about = log.metadata;
  run.t_s.reserve(rows);
  run.q.reserve(rows);
  run.tau.reserve(rows);
  for (auto tick = begin; tick != end; ++tick) {
    run.t_s.push_back(seconds_into(log, *tick));
    run.q.push_back(tick->q_rad);
    run.tau.push_back(tick->tau_Nm);
    if (touched) {
      run.contact.push_back(-linear_jacobian(arm, tick->q_rad).transpose() * tick->tool_force_N);
    }
    if (!measured) continue;
    JointVector torque = tick->motor_current_A;
    for (std::size_t i = 0; i < kJoints; ++i) {
      torque[static_cast<Eigen::Index>(i)] *=
          p.transmission_ratio.at(i) * p.torque_constant_Nm_per_A.at(i);
    }
    run.measured.push_back(torque);
  }
  const auto cuts = static_cast<std::size_t>(
      std::count_if(begin, end, [](const auto& tick) { return has(tick, ArmFlag::torque_cut); }));
  if (cuts > 0) {
    run.notes.push_back(
        fmt::format("in {} turn(s) the device cut the command to its own limit; "
                    "what is recorded is the command before",
                    cuts));
  }
  return run;
}

/// Runs of two logs of one name are told apart by their folders.
void add_runs(std::vector<Recording> runs, DiagnosisCase& to) {
  const std::string name = std::filesystem::path{runs.front().file}.filename().string();
  const bool known = std::any_of(to.runs.begin(), to.runs.end(), [&](const Recording& other) {
    return std::filesystem::path{other.file}.filename().string() == name;
  });
  for (Recording& run : runs) {
    if (known) run.name.replace(0, name.size(), run.file);
    to.runs.push_back(std::move(run));
  }
}

}  // namespace

std::vector<Recording> runs_of(const Log& log) {
  const double period_s = period_of(log);
  const ArmModel arm = load_arm(said(log, "arm"));
  check_counts(log, arm);
  const Stretches stretches{log, period_s};
  const std::vector<std::string> notes = stretches.notes();
  if (stretches.list().empty()) {
    throw ConfigError{fmt::format(
        "{}: holds no {} s of turns every {:g} ms with the amplifiers on{}", log.file.string(),
        kShortestRun_s, 1e3 * period_s, notes.empty() ? "" : ": " + notes.front())};
  }
  std::vector<Recording> runs;
  runs.reserve(stretches.list().size());
  for (const Stretch& stretch : stretches.list()) {
    Recording run = run_of(log, stretch, arm);
    if (stretches.list().size() > 1) {
      run.name += fmt::format("[{:.3f}..{:.3f}]", run.t_s.front(), run.t_s.back() + period_s);
    }
    runs.push_back(std::move(run));
  }
  runs.front().notes.insert(runs.front().notes.begin(), notes.begin(), notes.end());
  return runs;
}

std::vector<DiagnosisCase> read_log_cases(std::span<const std::filesystem::path> files) {
  std::vector<DiagnosisCase> cases;
  for (const std::filesystem::path& file : files) {
    const Log log = read_log(file);
    const std::string& arm = said(log, "arm");
    const std::string& role = said(log, "role");
    const double period_s = period_of(log);
    auto found = std::find_if(cases.begin(), cases.end(), [&](const DiagnosisCase& each) {
      return each.name == role && each.plant == arm;
    });
    if (found == cases.end()) {
      cases.push_back({.name = role,
                       .plant = arm,
                       .period_s = period_s,
                       .resolution = resolution_of(load_arm(arm))});
      found = cases.end() - 1;
    }
    if (found->period_s != period_s) {
      throw ConfigError{
          fmt::format("{}: has turns every {:g} ms, the {}'s first log every {:g} ms: "
                      "diagnose them apart",
                      file.string(), 1e3 * period_s, role, 1e3 * found->period_s)};
    }
    add_runs(runs_of(log), *found);
  }
  return cases;
}

}  // namespace teleop
