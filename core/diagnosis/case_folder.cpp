#include "core/diagnosis/case_folder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/csv_table.hpp"
#include "core/base/error.hpp"
#include "core/diagnosis/case_table.hpp"
#include "core/effects/text_file.hpp"
#include "core/model/arm_model.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBenchPlant = "rigid-axes";
constexpr const char* kTimeColumn = "t_s";

/// A column that adds to a force on an axis.
struct Input {
  std::string column{};
  std::size_t axis = 0;
  bool contact = false;
  double gain = 1.0;  ///< column's unit → N m or N
};

/// Where the numbers of a recording stand in its files.
struct Layout {
  std::vector<std::string> columns{};  ///< t_s, then the positions, then the inputs
  std::vector<Input> inputs{};
};

struct Window {
  double start_s = -std::numeric_limits<double>::infinity();
  double stop_s = std::numeric_limits<double>::infinity();
  bool stated = false;
};

// --- arms

Layout read_arm_tables(CaseTable& root, DiagnosisCase& out) {
  const ArmModel arm = [&] {
    try {
      return load_arm(out.plant);
    } catch (const ConfigError& error) {
      throw ConfigError{fmt::format("{}: plant = \"{}\": neither \"{}\" nor an arm: {}",
                                    root.place("plant"), out.plant, kBenchPlant, error.what())};
    }
  }();
  const auto counts = root.numbers("encoder_counts_per_joint_revolution", kJoints, kPositive);
  Layout layout{.columns = {kTimeColumn}};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double own = counts.empty() ? arm.parameters().encoder_counts_per_rev.at(i) : counts[i];
    out.resolution[static_cast<Eigen::Index>(i)] = 2.0 * std::numbers::pi / own;
    layout.columns.push_back(fmt::format("q{}_rad", i + 1));
    layout.inputs.push_back({.column = fmt::format("tau{}_Nm", i + 1), .axis = i});
  }
  out.command_step = root.number("torque_command_step_Nm", kNotNegative).value_or(0.0);
  return layout;
}

// --- benches

BenchAxis read_axis(CaseTable& table) {
  BenchAxis axis{.name = table.text("name")};
  const std::string motion = table.text("motion");
  if (motion != "prismatic" && motion != "revolute") {
    throw ConfigError{table.place("motion") + ": motion must be \"prismatic\" or \"revolute\""};
  }
  axis.prismatic = motion == "prismatic";
  axis.position_column = table.text("position");
  const CaseTable::Quantity inertia = table.quantity("inertia", kPositive);
  axis.inertia = inertia.value;
  if (inertia.stated) axis.inertia_tolerance = inertia.tolerance;
  if (auto gravity = table.table("gravity")) {
    if (gravity->text("kind") != "pendulum") {
      throw ConfigError{gravity->place("kind") + ": kind must be \"pendulum\""};
    }
    axis.pendulum = true;
    const CaseTable::Quantity moment = gravity->quantity("moment");
    if (moment.stated) {
      throw ConfigError{gravity->place("moment") + ": moment must be a number or \"free\""};
    }
    axis.moment = moment.value;
    gravity->refuse_others();
  } else if (table.text("gravity", "none") != "none") {
    throw ConfigError{table.place("gravity") +
                      ": gravity must be \"none\" or { kind = \"pendulum\", moment = \"free\" }"};
  }
  return axis;
}

std::size_t axis_named(const std::string& name, const CaseTable& table, const DiagnosisCase& out) {
  std::vector<std::string> known;
  known.reserve(out.bench.size());
  for (std::size_t i = 0; i < out.bench.size(); ++i) {
    if (out.bench[i].name == name) return i;
    known.push_back(out.bench[i].name);
  }
  throw ConfigError{fmt::format("{}: axis = \"{}\": there is no such axis; there are: {}",
                                table.place("axis"), name, fmt::join(known, ", "))};
}

/// Adds an input to its axis. Inputs of one role on one axis are added up, so their gains must be
/// numbers: one gain that is off could not be told from another.
Input read_input(CaseTable& table, DiagnosisCase& out) {
  Input input{.column = table.text("column"), .axis = axis_named(table.text("axis"), table, out)};
  const std::string role = table.text("role");
  if (role != "motor" && role != "contact") {
    throw ConfigError{table.place("role") + ": role must be \"motor\" or \"contact\""};
  }
  input.contact = role == "contact";
  const CaseTable::Quantity gain = table.quantity("gain");
  input.gain = gain.value.value_or(1.0);
  if (input.gain == 0.0) throw ConfigError{table.place("gain") + ": gain must not be 0"};
  BenchAxis& axis = out.bench[input.axis];
  std::string& column = input.contact ? axis.contact_column : axis.motor_column;
  const bool uncertain = !gain.value || gain.tolerance > 0.0;
  const bool other_uncertain =
      input.contact ? axis.contact_tolerance > 0.0 : axis.free_gain || axis.gain_tolerance > 0.0;
  if (!column.empty() && (uncertain || other_uncertain)) {
    throw ConfigError{fmt::format("{}: axis {} has several {} inputs: each gain must be a number",
                                  table.place("gain"), axis.name, role)};
  }
  if (input.contact && !gain.value) {
    throw ConfigError{table.place("gain") +
                      ": a contact input needs a gain; give { value = 1.0, tolerance = 1.0 } when "
                      "it is not known"};
  }
  column += (column.empty() ? "" : " + ") + input.column;
  if (input.contact) {
    axis.contact_tolerance = gain.tolerance;
  } else {
    axis.free_gain = !gain.value;
    axis.gain_tolerance = gain.tolerance;
  }
  return input;
}

void check_axes(const CaseTable& root, const DiagnosisCase& out) {
  if (out.bench.empty() || out.bench.size() > kJoints) {
    throw ConfigError{fmt::format("{}: {} [[axis]] tables: a bench has 1 to {} axes", root.place(),
                                  out.bench.size(), kJoints)};
  }
  for (const BenchAxis& axis : out.bench) {
    const auto twice =
        std::count_if(out.bench.begin(), out.bench.end(),
                      [&](const BenchAxis& other) { return other.name == axis.name; });
    if (twice > 1) {
      throw ConfigError{fmt::format("{}: axis {} is there twice", root.place(), axis.name)};
    }
  }
}

Layout read_bench_tables(CaseTable& root, DiagnosisCase& out) {
  Layout layout{.columns = {kTimeColumn}};
  for (CaseTable& table : root.tables("axis")) {
    out.bench.push_back(read_axis(table));
    layout.columns.push_back(out.bench.back().position_column);
    const auto resolution = table.number("resolution", kPositive);
    if (out.bench.size() <= kJoints) {
      out.resolution[static_cast<Eigen::Index>(out.bench.size() - 1)] = resolution.value_or(0.0);
    }
    table.refuse_others();
  }
  check_axes(root, out);
  for (CaseTable& table : root.tables("input")) {
    layout.inputs.push_back(read_input(table, out));
    table.refuse_others();
  }
  for (const BenchAxis& axis : out.bench) {
    if (axis.motor_column.empty() && axis.contact_column.empty()) {
      throw ConfigError{fmt::format("{}: axis {} has no [[input]]: nothing is known to move it",
                                    root.place(), axis.name)};
    }
    if (axis.free_gain && !axis.inertia && axis.contact_column.empty()) {
      throw ConfigError{
          fmt::format("{}: axis {}: inertia and gain are both free: no recording "
                      "tells them apart; give one of them",
                      root.place(), axis.name)};
    }
  }
  return layout;
}

// --- runs

Window read_window(CaseTable& table) {
  Window window;
  const auto start = table.number("start_s");
  const auto stop = table.number("stop_s");
  window.start_s = start.value_or(window.start_s);
  window.stop_s = stop.value_or(window.stop_s);
  window.stated = start || stop;
  if (window.start_s >= window.stop_s) {
    throw ConfigError{table.place("stop_s") + ": stop_s must be larger than start_s"};
  }
  return window;
}

/// Rows [first, second) of the table whose time stamps are in the window: those between the first
/// and the last of them, so that stamps out of order are not dropped in silence.
std::pair<std::size_t, std::size_t> rows_of(const CsvTable& table, const Window& window) {
  const auto& t_s = table.columns.front();
  const auto inside = [&](double t) {
    return t >= window.start_s && t < window.stop_s;
  };
  const auto first = std::find_if(t_s.begin(), t_s.end(), inside);
  const auto last = std::find_if(t_s.rbegin(), t_s.rend(), inside).base();
  if (first == t_s.end()) return {0, 0};
  return {static_cast<std::size_t>(first - t_s.begin()),
          static_cast<std::size_t>(last - t_s.begin())};
}

const std::vector<double>& column_of(const CsvTable& table, const std::string& name) {
  const auto found = std::find(table.names.begin(), table.names.end(), name);
  return table.columns[static_cast<std::size_t>(found - table.names.begin())];
}

/// Every column once, though two inputs may share one.
std::vector<std::string> columns_of(const Layout& layout) {
  std::vector<std::string> columns = layout.columns;
  for (const Input& input : layout.inputs) {
    if (std::find(columns.begin(), columns.end(), input.column) == columns.end()) {
      columns.push_back(input.column);
    }
  }
  return columns;
}

void fill(const CsvTable& table, const Layout& layout, const DiagnosisCase& of, Recording& run) {
  const auto begin = run.first_row - CsvTable::kFirstRow;
  const std::size_t rows = run.t_s.size();
  const bool touches = std::any_of(layout.inputs.begin(), layout.inputs.end(),
                                   [](const Input& input) { return input.contact; });
  run.q.assign(rows, JointVector::Zero());
  run.tau.assign(rows, JointVector::Zero());
  if (touches) run.contact.assign(rows, JointVector::Zero());
  for (std::size_t i = 0; i < of.axes(); ++i) {
    const std::vector<double>& position = column_of(table, layout.columns[1 + i]);
    for (std::size_t k = 0; k < rows; ++k) {
      run.q[k][static_cast<Eigen::Index>(i)] = position[begin + k];
    }
  }
  for (const Input& input : layout.inputs) {
    auto& sum = input.contact ? run.contact : run.tau;
    const std::vector<double>& column = column_of(table, input.column);
    for (std::size_t k = 0; k < rows; ++k) {
      sum[k][static_cast<Eigen::Index>(input.axis)] += input.gain * column[begin + k];
    }
  }
}

std::string name_of_run(const std::string& file, const Window& window) {
  if (!window.stated) return file;
  const auto end = [](double t_s) {
    return std::isfinite(t_s) ? fmt::format("{}", t_s) : "";
  };
  return fmt::format("{}[{}..{}]", file, end(window.start_s), end(window.stop_s));
}

Recording read_run(CaseTable& table,
                   const fs::path& folder,
                   const Layout& layout,
                   const DiagnosisCase& of) {
  const std::string file = table.text("file");
  Recording run{.name = file,
                .excitation = table.text("excitation", ""),
                .held_out = table.flag("held_out", false)};
  const Window window = read_window(table);
  table.refuse_others();
  const fs::path path = folder / file;
  run.file = path.string();
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw ConfigError{
        fmt::format("{}: {}: no such file; put it there or give the folder that has "
                    "it with --data",
                    table.place("file"), run.file)};
  }
  const CsvTable csv = read_csv(path, columns_of(layout));
  const auto [first, last] = rows_of(csv, window);
  if (first == last) {
    throw ConfigError{fmt::format("{}: {} has no row with {} <= t_s < {}; its last one is at {} s",
                                  table.place("file"), file, window.start_s, window.stop_s,
                                  csv.columns.front().back())};
  }
  run.name = name_of_run(file, window);
  run.first_row = CsvTable::kFirstRow + first;
  const auto& t_s = csv.columns.front();
  run.t_s.assign(t_s.begin() + static_cast<std::ptrdiff_t>(first),
                 t_s.begin() + static_cast<std::ptrdiff_t>(last));
  if (!csv.ignored.empty()) {
    run.notes.push_back(fmt::format("not used: {}", fmt::join(csv.ignored, ", ")));
  }
  fill(csv, layout, of, run);
  return run;
}

toml::table parse(const fs::path& file) {
  try {
    return toml::parse(read_text(file, "case file"), file.string());
  } catch (const toml::parse_error& error) {
    throw ConfigError{fmt::format("{}:{}: not TOML: {}", file.string(), error.source().begin.line,
                                  error.description())};
  }
}

void read_runs(CaseTable& root, const fs::path& folder, const Layout& layout, DiagnosisCase& out) {
  std::vector<CaseTable> tables = root.tables("run");
  if (tables.empty()) {
    throw ConfigError{root.place() + ": there is no [[run]]; list the recordings of the case"};
  }
  root.refuse_others();
  out.runs.reserve(tables.size());
  for (CaseTable& table : tables) {
    Recording run = read_run(table, folder, layout, out);
    const bool known = std::any_of(out.runs.begin(), out.runs.end(),
                                   [&](const Recording& other) { return other.name == run.name; });
    if (known) {
      throw ConfigError{fmt::format("{}: {} is there twice", table.place("file"), run.name)};
    }
    out.runs.push_back(std::move(run));
  }
  if (std::all_of(out.runs.begin(), out.runs.end(), [](const auto& run) { return run.held_out; })) {
    throw ConfigError{root.place("run") + ": every run is held out: none is left for the fit"};
  }
}

DiagnosisCase case_of(const toml::table& parsed,
                      const fs::path& file,
                      const std::string& otherwise_named,
                      const fs::path& data) {
  const std::string name = file.string();
  CaseTable root{parsed, name};
  DiagnosisCase out{.name = root.text("case", otherwise_named), .plant = root.text("plant")};
  const auto rate = root.number("sample_rate_Hz", kPositive);
  if (!rate) {
    throw ConfigError{root.place() + ": sample_rate_Hz is missing; add sample_rate_Hz = 1000"};
  }
  out.period_s = 1.0 / *rate;
  static_cast<void>(root.text("torque_convention", "-"));  // the one that a Recording states
  const Layout layout =
      out.plant == kBenchPlant ? read_bench_tables(root, out) : read_arm_tables(root, out);
  read_runs(root, data.empty() ? file.parent_path() : data, layout, out);
  return out;
}

}  // namespace

DiagnosisCase read_case(const fs::path& path, const fs::path& data) {
  std::error_code error;
  const bool is_folder = fs::is_directory(path, error);
  const fs::path file = is_folder ? path / "case.toml" : path;
  const fs::path own = fs::absolute(file).parent_path();
  return case_of(parse(file), file, is_folder ? own.filename().string() : file.stem().string(),
                 data);
}

DiagnosisCase read_case_of_run(const fs::path& recording) {
  const fs::path file = recording.parent_path() / "case.toml";
  if (!fs::exists(file)) {
    throw ConfigError{fmt::format("{}: no case.toml beside it, which tells rate and columns",
                                  recording.string())};
  }
  toml::table parsed = parse(file);
  toml::table run;
  run.insert_or_assign("file", recording.filename().string());
  toml::array runs;
  runs.push_back(std::move(run));
  parsed.insert_or_assign("run", std::move(runs));
  return case_of(parsed, file, file.parent_path().filename().string(), {});
}

}  // namespace teleop
