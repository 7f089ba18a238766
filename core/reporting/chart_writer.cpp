#include "core/reporting/chart_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

/// Five digits are finer than a pixel; NaN is null.
std::string numbers(std::span<const double> values) {
  std::string out{"["};
  for (const double value : values) {
    if (out.size() > 1) out += ',';
    if (std::isfinite(value)) {
      fmt::format_to(std::back_inserter(out), "{:.5g}", value);
    } else {
      out += "null";
    }
  }
  return out + "]";
}

}  // namespace

std::vector<TimedSide> timed_sides(const Run& run) {
  std::vector<TimedSide> sides;
  for (const Side* side : run.sides()) {
    const Log& log = *side->log;
    TimedSide timed{.role = role_of(log), .log = &log};
    timed.t_s.reserve(log.ticks.size());
    for (const TickRecord& record : log.ticks) {
      timed.t_s.push_back(side->clock.seconds(record.stamp_ns));
    }
    sides.push_back(std::move(timed));
  }
  return sides;
}

void ChartWriter::begin(const ChartText& text) {
  if (!out_.empty()) out_ += "]},\n";
  out_ += fmt::format(R"({{"id":"{}","title":"{}","unit":"{}","note":"{}","series":[)", text.id,
                      text.title, text.unit, text.note);
  first_ = true;
}

void ChartWriter::series(const std::string& label,
                         const std::string& color,
                         bool dashed,
                         std::span<const double> points) {
  const bool empty =
      std::none_of(points.begin(), points.end(), [](double value) { return std::isfinite(value); });
  if (empty) return;
  if (!first_) out_ += ",\n";
  first_ = false;
  out_ += fmt::format(R"({{"label":"{}","color":"{}","dashed":{},"values":{}}})", label, color,
                      dashed, numbers(points));
}

void ChartWriter::scalar(const Scalar& value, const std::string& suffix, bool dashed) {
  for (const TimedSide& side : sides_) {
    series(name_of(side.role) + suffix, name_of(side.role), dashed, sampled(side, value));
  }
}

void ChartWriter::vector(const Vector& value) {
  for (const TimedSide& side : sides_) {
    vector(side, value, name_of(side.role), side.role);
  }
}

void ChartWriter::vector(const TimedSide& side,
                         const Vector& value,
                         const std::string& label,
                         Role look) {
  constexpr std::array kAxes{"x", "y", "z"};
  const bool dashed = look == Role::slave;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const char* name = kAxes.at(static_cast<std::size_t>(axis));
    series(fmt::format("{} {}", label, name), fmt::format("{}{}", name, dashed ? "-slave" : ""),
           dashed, sampled(side, [&](const TickRecord& record) { return value(record)[axis]; }));
  }
}

void ChartWriter::paired(const std::string& label,
                         const std::string& color,
                         std::span<const PairedTick> pairs,
                         const std::function<double(const Vector3&)>& of) {
  std::vector<double> t_s;
  std::vector<double> values;
  for (const PairedTick& pair : pairs) {
    t_s.push_back(pair.t_s);
    values.push_back(of(1e3 * pair.error));
  }
  series(label, color, false, decimate(grid_, t_s, values));
}

std::vector<double> ChartWriter::sampled(const TimedSide& side, const Scalar& value) const {
  std::vector<double> values;
  values.reserve(side.log->ticks.size());
  for (const TickRecord& record : side.log->ticks) {
    values.push_back(value(record));
  }
  return decimate(grid_, side.t_s, values);
}

}  // namespace teleop
