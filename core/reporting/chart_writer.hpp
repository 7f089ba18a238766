#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/reporting/decimate.hpp"
#include "core/reporting/metrics.hpp"

namespace teleop {

/// One side with the time of each of its records.
struct TimedSide {
  Role role = Role::master;
  const Log* log = nullptr;
  std::vector<double> t_s{};
};

[[nodiscard]] std::vector<TimedSide> timed_sides(const Run& run);

struct ChartText {
  const char* id = "";
  const char* title = "";
  const char* unit = "";
  const char* note = "";
};

/// A number of a record, NaN where there is none.
using Scalar = std::function<double(const TickRecord&)>;
using Vector = std::function<Vector3(const TickRecord&)>;

/// Writes charts as JSON text, one after the other, with their series cut to a grid. The arrays of
/// numbers, nearly all of a page, are written at once instead of through a tree of values. A series
/// without any number is left out. Refers to sides and grid: they must outlive it.
class ChartWriter {
 public:
  ChartWriter(const std::vector<TimedSide>& sides, const TimeGrid& grid)
      : sides_{sides}, grid_{grid} {}

  /// What follows goes into this chart.
  void begin(const ChartText& text);

  /// The same number of either side, one colour a side.
  void scalar(const Scalar& value, const std::string& suffix = "", bool dashed = false);

  /// x, y and z of either side, one colour an axis, the slave dashed.
  void vector(const Vector& value);

  /// x, y and z of one side's records, drawn as of `look`.
  void vector(const TimedSide& side, const Vector& value, const std::string& label, Role look);

  /// A number of the tracking error in mm.
  void paired(const std::string& label,
              const std::string& color,
              std::span<const PairedTick> pairs,
              const std::function<double(const Vector3&)>& of);

  /// A number of one side; `color` names one of the page's colours.
  void series(const std::string& label,
              const std::string& color,
              bool dashed,
              std::span<const double> points);

  [[nodiscard]] std::vector<double> sampled(const TimedSide& side, const Scalar& value) const;

  [[nodiscard]] std::string text() const { return "[" + out_ + (out_.empty() ? "]" : "]}]"); }
  [[nodiscard]] const std::vector<TimedSide>& sides() const { return sides_; }

 private:
  const std::vector<TimedSide>& sides_;
  const TimeGrid& grid_;
  std::string out_;
  bool first_ = true;
};

}  // namespace teleop
