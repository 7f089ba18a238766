#include "core/diagnosis/audit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/diagnosis/audit_checks.hpp"

namespace teleop {
namespace {

constexpr double kShortest_s = 1.0;        ///< of all runs for the fit together
constexpr double kShortestUseful_s = 0.5;  ///< of one run
constexpr double kLeastMotion = 10.0;      ///< steps of the reading

/// How far an axis moves in a run, in steps of its reading.
double motion_of(const DiagnosisCase& of, const Recording& run, std::size_t axis) {
  const std::vector<double> q = axis_of(run.q, axis);
  const double quantum = quantum_of(q, of.resolution[static_cast<Eigen::Index>(axis)]);
  if (q.empty() || quantum == 0.0) return 0.0;
  const auto [low, high] = std::minmax_element(q.begin(), q.end());
  return (*high - *low) / quantum;
}

/// What is wrong with the case as a whole.
void audit_excitation(const DiagnosisCase& of, std::vector<Finding>& findings) {
  double length_s = 0.0;
  std::vector<double> motion(of.axes(), 0.0);
  for (const Recording& run : of.runs) {
    if (run.held_out) continue;
    length_s += static_cast<double>(run.rows()) * of.period_s;
    for (std::size_t i = 0; i < of.axes(); ++i) {
      motion[i] = std::max(motion[i], motion_of(of, run, i));
    }
  }
  const auto add = [&](Severity severity, const char* kind, const std::string& column,
                       std::string text) {
    findings.push_back({.severity = severity,
                        .kind = kind,
                        .run = "",
                        .file = of.name,
                        .column = column,
                        .text = std::move(text)});
  };
  if (length_s < kShortest_s) {
    add(Severity::fatal, "too_short", "",
        fmt::format("the runs for the fit are {:.3g} s long together: record at least {:g} s",
                    length_s, kShortest_s));
  }
  const auto still = static_cast<std::size_t>(
      std::count_if(motion.begin(), motion.end(), [](double m) { return m < kLeastMotion; }));
  if (still == of.axes()) {
    add(Severity::fatal, "no_excitation", "",
        fmt::format("no axis moves by {:g} steps of its reading: record a motion", kLeastMotion));
    return;
  }
  for (std::size_t i = 0; i < of.axes(); ++i) {
    if (motion[i] >= kLeastMotion) continue;
    add(Severity::warning, "little_motion", position_column(of, i),
        fmt::format("moves by {:.0f} steps of its reading in all runs for the fit: what is wrong "
                    "with this axis cannot be found",
                    motion[i]));
  }
}

void audit_run(const AuditNotes& notes) {
  const Recording& run = notes.run();
  for (const std::string& note : run.notes) {
    notes.add(Severity::note, "note", "", {}, note);
  }
  const double length_s = static_cast<double>(run.rows()) * notes.of().period_s;
  if (length_s < kShortestUseful_s) {
    notes.add(Severity::warning, "short_run", "", 0,
              fmt::format("{} rows, {:.3g} s: too short to tell much", run.rows(), length_s));
  }
  const bool has_time = audit_stamps(notes);
  audit_columns(notes);
  audit_readings(notes);
  if (!has_time || notes.fatal()) return;  // the rest would follow from that
  audit_motion(notes);
  audit_currents(notes);
}

}  // namespace

bool AuditNotes::fatal() const noexcept {
  return std::any_of(findings_.begin(), findings_.end(), [&](const Finding& finding) {
    return finding.severity == Severity::fatal && finding.run == run_.name;
  });
}

std::string position_column(const DiagnosisCase& of, std::size_t axis) {
  return of.bench.empty() ? fmt::format("q{}_rad", axis + 1) : of.bench[axis].position_column;
}

std::string command_column(const DiagnosisCase& of, std::size_t axis) {
  return of.bench.empty() ? fmt::format("tau{}_Nm", axis + 1) : of.bench[axis].motor_column;
}

std::vector<double> axis_of(const std::vector<JointVector>& rows, std::size_t axis) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const JointVector& row : rows) {
    values.push_back(row[static_cast<Eigen::Index>(axis)]);
  }
  return values;
}

double quantum_of(const std::vector<double>& q, double stated) {
  if (stated > 0.0) return stated;
  double smallest = 0.0;
  for (std::size_t k = 1; k < q.size(); ++k) {
    const double step = std::abs(q[k] - q[k - 1]);
    if (step > 0.0 && (smallest == 0.0 || step < smallest)) smallest = step;
  }
  return smallest;
}

const char* name_of(Severity severity) noexcept {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::fatal:
      return "fatal";
  }
  return "unknown";
}

std::string line_of(const Finding& finding) {
  std::string line = finding.file;
  if (finding.row > 0) line += fmt::format(":{}", finding.row);
  if (!finding.column.empty()) line += ": " + finding.column;
  return line + ": " + finding.text;
}

bool Audit::fatal() const noexcept {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.severity == Severity::fatal; });
}

Audit audit(const DiagnosisCase& of) {
  Audit result;
  std::optional<ArmModel> arm;
  if (of.bench.empty()) arm = load_arm(of.plant);
  for (const Recording& run : of.runs) {
    audit_run(AuditNotes{of, arm ? &arm.value() : nullptr, run, result.findings});
  }
  audit_excitation(of, result.findings);
  return result;
}

void refuse_fatal(const Audit& audit) {
  for (const Finding& finding : audit.findings) {
    if (finding.severity == Severity::fatal) throw ConfigError{line_of(finding)};
  }
}

}  // namespace teleop
