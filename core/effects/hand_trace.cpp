#include "core/effects/hand_trace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/csv_table.hpp"
#include "core/base/error.hpp"
#include "core/effects/text_file.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

/// Bends the end of the trace to its beginning, at no more than kClosingSpeed on average.
void close(HandTrace& trace, double metres_per_unit) {
  constexpr double kClosingSpeed = 0.1;
  constexpr double kShortest = 0.1;
  const Vector3 gap = trace.values.front() - trace.values.back();
  const double length = trace.t_s.back() - trace.t_s.front();
  const double wanted = gap.norm() * metres_per_unit / kClosingSpeed;
  const double blend = std::min(std::max(wanted, kShortest), length / 2.0);
  for (std::size_t i = 0; i < trace.t_s.size(); ++i) {
    trace.values[i] += minimum_jerk(1.0 - (trace.t_s.back() - trace.t_s[i]) / blend) * gap;
  }
}

/// Catmull–Rom tangents of a closed trace: the slope of the parabola through a point and its
/// neighbours, its last point being its first.
std::vector<Vector3> tangents_of(const HandTrace& trace) {
  const std::size_t last = trace.t_s.size() - 1;
  std::vector<Vector3> tangents(trace.t_s.size());
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t before = i == 0 ? last - 1 : i - 1;
    const std::size_t at = i == 0 ? last : i;  // the step that leads to this point ends here
    const std::size_t from = i == last ? 0 : i;
    const double step_in = trace.t_s[at] - trace.t_s[before];
    const double step_out = trace.t_s[from + 1] - trace.t_s[from];
    const Vector3 slope_in = (trace.values[at] - trace.values[before]) / step_in;
    const Vector3 slope_out = (trace.values[from + 1] - trace.values[from]) / step_out;
    tangents[i] = (slope_in * step_out + slope_out * step_in) / (step_in + step_out);
  }
  return tangents;
}

/// The value and slope at u, 0 to 1, of the cubic between two points.
HandKnot hermite(const HandKnot& a, const HandKnot& b, double step, double u) {
  const Vector3 rise = b.p - a.p;
  const Vector3 c2 = 3.0 * rise - step * (2.0 * a.v + b.v);
  const Vector3 c3 = -2.0 * rise + step * (a.v + b.v);
  return {.p = a.p + u * (step * a.v + u * (c2 + u * c3)),
          .v = a.v + u * (2.0 * c2 + 3.0 * u * c3) / step};
}

HandKnot at_tool(const HandKnot& value, HandTrace::Column column, const ArmModel& arm) {
  if (column == HandTrace::Column::position) return value;
  return {.p = tool_position(arm, value.p), .v = linear_jacobian(arm, value.p) * value.v};
}

}  // namespace

HandTrace parse_hand_trace(std::string_view csv, const std::string& file) {
  const std::vector<std::string> names = csv_names(csv);
  const bool angle = std::find(names.begin(), names.end(), "q_rad") != names.end();
  const std::vector<std::string> wanted =
      angle ? std::vector<std::string>{"t_s", "q_rad"}
            : std::vector<std::string>{"t_s", "x_m", "y_m", "z_m"};
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw ConfigError{fmt::format(
        "{}:1: column {} is missing; a trace has t_s,q_rad or t_s,x_m,y_m,z_m", file, name)};
  }
  CsvTable table = parse_csv(csv, file, wanted);
  const std::size_t rows = table.rows();
  HandTrace trace{.column = angle ? HandTrace::Column::yaw_angle : HandTrace::Column::position};
  trace.t_s = std::move(table.columns[0]);
  trace.values.assign(rows, Vector3::Zero());
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t i = 1; i < wanted.size(); ++i) {
      trace.values[k][static_cast<Eigen::Index>(i - 1)] = table.columns[i][k];
    }
    if (k == 0 || trace.t_s[k] > trace.t_s[k - 1]) continue;
    throw ConfigError{fmt::format("{}:{}: t_s = {} after {}: time must increase", file,
                                  CsvTable::kFirstRow + k, trace.t_s[k], trace.t_s[k - 1])};
  }
  if (rows < 2) {
    throw ConfigError{fmt::format("{}:{}: a trace needs at least two rows of numbers", file,
                                  CsvTable::kFirstRow + rows - 1)};
  }
  return trace;
}

HandTrace read_hand_trace(const std::filesystem::path& file) {
  return parse_hand_trace(read_text(file, "trace file"), file.string());
}

std::vector<HandKnot> closed_loop_of(const HandTrace& trace, const ArmModel& arm) {
  HandTrace closed = trace;
  close(closed, trace.column == HandTrace::Column::position ? 1.0 : arm.parameters().l1_m);
  const std::vector<Vector3> tangents = tangents_of(closed);
  const double length = closed.t_s.back() - closed.t_s.front();
  const auto knots = std::max(1L, std::lround(length / seconds(kKnotPeriod)));
  const double stretch = static_cast<double>(knots) * seconds(kKnotPeriod) / length;

  std::vector<HandKnot> loop;
  std::size_t i = 0;
  for (long k = 0; k < knots; ++k) {
    const double t =
        closed.t_s.front() + length * static_cast<double>(k) / static_cast<double>(knots);
    while (i + 2 < closed.t_s.size() && closed.t_s[i + 1] <= t) {
      ++i;
    }
    const double step = closed.t_s[i + 1] - closed.t_s[i];
    HandKnot knot =
        hermite({closed.values[i], tangents[i]}, {closed.values[i + 1], tangents[i + 1]}, step,
                (t - closed.t_s[i]) / step);
    knot.v /= stretch;
    loop.push_back(at_tool(knot, closed.column, arm));
  }
  return loop;
}

}  // namespace teleop
