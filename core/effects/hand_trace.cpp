#include "core/effects/hand_trace.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/text_file.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && cell.front() == ' ') {
      cell.remove_prefix(1);
    }
    while (!cell.empty() && cell.back() == ' ') {
      cell.remove_suffix(1);
    }
    cells.push_back(cell);
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> finite_number(std::string_view cell) {
  double value = 0.0;
  const char* const begin = std::to_address(cell.begin());
  const char* const end = begin + cell.size();
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Lines without their ends; rows count from 1 as editors do.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_{text} {}

  [[nodiscard]] std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++row_;
    return line;
  }
  [[nodiscard]] std::size_t row() const { return row_; }

 private:
  std::string_view rest_;
  std::size_t row_ = 0;
};

/// Which cells of a row are wanted, by their names in the header.
struct Columns {
  HandTrace::Column kind = HandTrace::Column::yaw_angle;
  std::size_t number = 0;  ///< of the header
  std::vector<std::size_t> wanted{};
  std::vector<std::string_view> names{};
};

Columns columns_of(std::string_view header, const std::string& file) {
  const auto cells = cells_of(header);
  Columns columns{.number = cells.size()};
  const bool angle = std::find(cells.begin(), cells.end(), "q_rad") != cells.end();
  columns.kind = angle ? HandTrace::Column::yaw_angle : HandTrace::Column::position;
  columns.names = angle ? std::vector<std::string_view>{"t_s", "q_rad"}
                        : std::vector<std::string_view>{"t_s", "x_m", "y_m", "z_m"};
  for (const std::string_view name : columns.names) {
    const auto found = std::find(cells.begin(), cells.end(), name);
    if (found == cells.end()) {
      throw ConfigError{fmt::format(
          "{}:1: column {} is missing; a trace has t_s,q_rad or t_s,x_m,y_m,z_m", file, name)};
    }
    columns.wanted.push_back(static_cast<std::size_t>(found - cells.begin()));
  }
  return columns;
}

void add_row(const Columns& columns,
             const std::vector<std::string_view>& cells,
             const std::string& place,
             HandTrace& trace) {
  if (cells.size() != columns.number) {
    throw ConfigError{
        fmt::format("{}: {} cells, the header has {}", place, cells.size(), columns.number)};
  }
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < columns.wanted.size(); ++i) {
    const auto value = finite_number(cells[columns.wanted[i]]);
    if (!value) {
      throw ConfigError{fmt::format("{}: {} = '{}': not a finite number", place, columns.names[i],
                                    cells[columns.wanted[i]])};
    }
    numbers.at(i) = *value;
  }
  if (!trace.t_s.empty() && numbers[0] <= trace.t_s.back()) {
    throw ConfigError{fmt::format("{}: t_s = {} after {}: time must increase", place, numbers[0],
                                  trace.t_s.back())};
  }
  trace.t_s.push_back(numbers[0]);
  trace.values.emplace_back(numbers[1], numbers[2], numbers[3]);
}

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
  Lines lines{csv};
  const auto header = lines.next();
  if (!header) throw ConfigError{fmt::format("{}: is empty", file)};
  const Columns columns = columns_of(*header, file);
  HandTrace trace{.column = columns.kind};
  while (const auto line = lines.next()) {
    if (line->empty() && !trace.t_s.empty()) continue;  // a last blank line is nobody's mistake
    add_row(columns, cells_of(*line), fmt::format("{}:{}", file, lines.row()), trace);
  }
  if (trace.t_s.size() < 2) {
    throw ConfigError{
        fmt::format("{}:{}: a trace needs at least two rows of numbers", file, lines.row())};
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
