#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/diagnosis/audit_checks.hpp"

namespace teleop {
namespace {

constexpr std::size_t kStuckRows = 10;  ///< at the largest command, while the reading moves on
constexpr double kStuckMotion = 3.0;    ///< steps of the reading in between
constexpr double kMovingSteps = 4.0;    ///< steps of the reading a row: it cannot stand in between
constexpr double kWholeTolerance = 0.05;  ///< steps of the reading or of the command
constexpr double kFewOff = 0.01;          ///< share of the rows
constexpr double kMostOff = 0.5;
constexpr double kBeyondStops_rad = 0.5;

bool is_constant(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [&](double value) { return value == values.front(); });
}

void find_constants(const AuditNotes& notes, std::size_t axis) {
  const DiagnosisCase& of = notes.of();
  const auto tell = [&](const std::vector<JointVector>& rows, const std::string& column) {
    const std::vector<double> values = axis_of(rows, axis);
    if (column.empty() || values.size() < 2 || !is_constant(values)) return;
    notes.add(Severity::warning, "constant_column", column, 0,
              fmt::format("is {:g} in every row: is the column, its sensor or its wire dead?",
                          values.front()));
  };
  tell(notes.run().q, position_column(of, axis));
  tell(notes.run().tau, command_column(of, axis));
  if (!of.bench.empty()) tell(notes.run().contact, of.bench[axis].contact_column);
}

/// Longest time in a row at which the command stands at its largest magnitude while the reading
/// moves: a controller that sees the motion would have changed it.
void find_saturation(const AuditNotes& notes, std::size_t axis) {
  const std::vector<double> u = axis_of(notes.run().tau, axis);
  const std::vector<double> q = axis_of(notes.run().q, axis);
  const double quantum = quantum_of(q, notes.of().resolution[static_cast<Eigen::Index>(axis)]);
  double largest = 0.0;
  for (const double value : u) {
    largest = std::max(largest, std::abs(value));
  }
  if (largest == 0.0 || quantum == 0.0 || is_constant(u)) return;
  std::size_t rows = 0;
  std::size_t first = 0;
  for (std::size_t k = 0; k < u.size();) {
    std::size_t end = k;
    while (end < u.size() && u[end] == u[k]) {
      ++end;
    }
    const bool stuck = std::abs(u[k]) == largest && end - k >= kStuckRows &&
                       std::abs(q[end - 1] - q[k]) >= kStuckMotion * quantum;
    if (stuck && rows == 0) first = k;
    if (stuck) rows += end - k;
    k = end;
  }
  if (rows == 0) return;
  notes.add(
      Severity::warning, "saturation", command_column(notes.of(), axis), first,
      fmt::format("stands at its largest magnitude, {:g}, for {} row(s) while the axis moves: "
                  "a limit cuts it; if what was applied is not what is written, cut them out",
                  largest, rows));
}

/// Rows that repeat the one before although the axes were and are on the move: a logger that
/// wrote a row twice. At rest equal rows are nothing strange.
void find_repeats(const AuditNotes& notes) {
  const Recording& run = notes.run();
  std::vector<double> least(notes.of().axes());
  for (std::size_t i = 0; i < least.size(); ++i) {
    const double stated = notes.of().resolution[static_cast<Eigen::Index>(i)];
    least[i] = kMovingSteps * quantum_of(axis_of(run.q, i), stated);
  }
  const auto moves = [&](std::size_t k) {
    for (std::size_t i = 0; i < least.size(); ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double before = run.q[k - 1][axis] - run.q[k - 2][axis];
      const double after = run.q[k + 1][axis] - run.q[k][axis];
      if (least[i] > 0.0 && std::abs(before) >= least[i] && before * after > 0.0) return true;
    }
    return false;
  };
  std::size_t repeats = 0;
  std::size_t first = 0;
  for (std::size_t k = 2; k + 1 < run.rows(); ++k) {
    const bool same = run.q[k] == run.q[k - 1] && run.tau[k] == run.tau[k - 1];
    if (!same || !moves(k)) continue;
    if (repeats++ == 0) first = k;
  }
  if (repeats == 0) return;
  notes.add(
      Severity::warning, "repeated_rows", "", first,
      fmt::format("{} row(s) repeat the one before in the middle of a motion: the logger wrote "
                  "a reading twice; cut them out",
                  repeats));
}

/// Rows whose value is no whole number of steps, from an origin.
struct OffGrid {
  std::size_t rows = 0;
  std::size_t first = 0;
};
OffGrid off_grid(const std::vector<double>& values, double step, double origin) {
  OffGrid off;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double steps = (values[k] - origin) / step;
    if (std::abs(steps - std::round(steps)) < kWholeTolerance) continue;
    if (off.rows++ == 0) off.first = k;
  }
  return off;
}

void find_off_step(const AuditNotes& notes, std::size_t axis) {
  const double step = notes.of().command_step;
  if (step <= 0.0) return;
  const std::vector<double> u = axis_of(notes.run().tau, axis);
  const OffGrid off = off_grid(u, step, 0.0);
  if (static_cast<double>(off.rows) <= kFewOff * static_cast<double>(u.size())) return;
  notes.add(
      Severity::warning, "off_command_step", command_column(notes.of(), axis), off.first,
      fmt::format("{:g} and {} more row(s) are no multiples of the command's step {:g} N m: is "
                  "this the measured current in place of the command?",
                  u[off.first], off.rows - 1, step));
}

void find_off_grid(const AuditNotes& notes, std::size_t axis) {
  const double step = notes.of().resolution[static_cast<Eigen::Index>(axis)];
  const std::vector<double> q = axis_of(notes.run().q, axis);
  if (step <= 0.0 || q.empty()) return;
  const bool arm = notes.arm() != nullptr;
  const OffGrid off = off_grid(q, step, arm ? 0.0 : q.front());
  if (off.rows == 0) return;
  const double share = static_cast<double>(off.rows) / static_cast<double>(q.size());
  const std::string column = position_column(notes.of(), axis);
  const std::string what = fmt::format(
      "{:.7g} and {} more row(s) are no whole number of steps of "
      "{:.6g}",
      q[off.first], off.rows - 1, step);
  if (arm && share > kMostOff) {
    notes.add(Severity::fatal, "wrong_readings", column, off.first,
              what + ": the run is of another arm or in another unit");
  } else if (share > kFewOff) {
    notes.add(Severity::warning, "off_grid", column, off.first,
              what + ": filtered, interpolated or of another encoder");
  } else {
    notes.add(Severity::warning, "off_grid", column, off.first, what + ": damaged readings?");
  }
}

void find_beyond_stops(const AuditNotes& notes, std::size_t axis) {
  if (notes.arm() == nullptr) return;
  const auto& p = notes.arm()->parameters();
  const double low = p.lower_limit_rad.at(axis);
  const double high = p.upper_limit_rad.at(axis);
  const std::vector<double> q = axis_of(notes.run().q, axis);
  const auto beyond = std::find_if(q.begin(), q.end(), [&](double angle) {
    return angle < low - kBeyondStops_rad || angle > high + kBeyondStops_rad;
  });
  if (beyond == q.end()) return;
  const bool degrees = std::all_of(q.begin(), q.end(), [&](double angle) {
    const double rad = angle * std::numbers::pi / 180.0;
    return rad > low && rad < high;
  });
  notes.add(Severity::fatal, "wrong_readings", position_column(notes.of(), axis),
            static_cast<std::size_t>(beyond - q.begin()),
            fmt::format("{:.6g} rad is far outside the arm's joint stops, {:.3g} to {:.3g} rad: {}",
                        *beyond, low, high,
                        degrees ? "these may be degrees; convert them to rad"
                                : "the run is of another arm or in another unit"));
}

}  // namespace

void audit_columns(const AuditNotes& notes) {
  find_repeats(notes);
  for (std::size_t i = 0; i < notes.of().axes(); ++i) {
    find_constants(notes, i);
    find_saturation(notes, i);
    find_off_step(notes, i);
  }
}

void audit_readings(const AuditNotes& notes) {
  for (std::size_t i = 0; i < notes.of().axes(); ++i) {
    find_beyond_stops(notes, i);
    find_off_grid(notes, i);
  }
}

}  // namespace teleop
