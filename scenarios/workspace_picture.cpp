#include "scenarios/workspace_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace teleop {
namespace {

constexpr double kMillimetres = 1000.0;
constexpr int kLevels = 9;            ///< lines at μ = 0.1 … 0.9
constexpr double kLabelRoom = 0.009;  ///< clear space around a label, m
constexpr double kLabelHalfWidth = 0.012;
constexpr double kLabelHalfHeight = 0.009;
constexpr double kLabelDistance = 0.150;  ///< between labels of one line, m

using Segment = std::pair<Vector3, Vector3>;
using Segments = std::vector<Segment>;

/// Text as it grows: every call appends.
class Script {
 public:
  template <typename... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
  }
  void add_point(const Vector3& p) {
    add("{:.2f},{:.2f}\n", kMillimetres * p.z(), kMillimetres * p.y());
  }
  void add_block(const char* name, const std::vector<Vector3>& line) {
    add("${} << END\n", name);
    for (const Vector3& p : line) {
      add_point(p);
    }
    add("END\n");
  }
  void add_label(std::string_view text, const Vector3& p, std::string_view how) {
    add("set label \"{}\" at {:.1f},{:.1f} {} front font \",16\"\n", text, kMillimetres * p.z(),
        kMillimetres * p.y(), how);
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// The pieces of the line μ = level, one or two a grid square, where all four corners are known.
Segments contour(const WorkspaceMap& map, double level) {
  static constexpr std::array<std::pair<std::size_t, std::size_t>, 4> kCorners{
      {{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
  Segments segments;
  for (std::size_t row = 0; row + 1 < map.rows; ++row) {
    for (std::size_t column = 0; column + 1 < map.columns; ++column) {
      std::vector<Vector3> crossings;
      bool known = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [row_a, column_a] = kCorners.at(k);
        const auto [row_b, column_b] = kCorners.at((k + 1) % 4);
        const double a = map.cell(row + row_a, column + column_a).mu;
        const double b = map.cell(row + row_b, column + column_b).mu;
        known = known && a > 0.0;
        if ((a < level) == (b < level)) continue;
        const Vector3 p_a = map.position(row + row_a, column + column_a);
        const Vector3 p_b = map.position(row + row_b, column + column_b);
        crossings.emplace_back(p_a + (p_b - p_a) * ((level - a) / (b - a)));
      }
      for (std::size_t k = 0; known && k + 1 < crossings.size(); k += 2) {
        segments.emplace_back(crossings[k], crossings[k + 1]);
      }
    }
  }
  return segments;
}

bool is_reachable(const WorkspaceMap& map, const Vector3& p) {
  const double row = std::round((p.y() - map.y_first_m) / map.step_m);
  const double column = std::round((p.z() - map.z_first_m) / map.step_m);
  return map.cell(static_cast<std::size_t>(row), static_cast<std::size_t>(column)).reach ==
         Reach::ok;
}

double distance(const Vector3& p, const std::vector<Vector3>& points) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3& q : points) {
    nearest = std::min(nearest, (p - q).squaredNorm());
  }
  return std::sqrt(nearest);
}

bool is_under_label(const Vector3& p, const std::vector<Vector3>& labels) {
  return std::any_of(labels.begin(), labels.end(), [&p](const Vector3& label) {
    return std::abs(p.z() - label.z()) < kLabelHalfWidth &&
           std::abs(p.y() - label.y()) < kLabelHalfHeight;
  });
}

/// Up to two places on a line, those with the most room to `obstacles`.
std::vector<Vector3> label_places(const WorkspaceMap& map,
                                  const Segments& line,
                                  const std::vector<Vector3>& obstacles) {
  std::vector<std::pair<double, Vector3>> candidates;
  for (std::size_t i = 0; i < line.size(); i += 3) {
    const Vector3 p = (line[i].first + line[i].second) / 2.0;
    if (is_reachable(map, p)) candidates.emplace_back(distance(p, obstacles), p);
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Vector3> places;
  for (const auto& [room, p] : candidates) {
    if (places.size() == 2 || room < kLabelRoom) break;
    if (distance(p, places) > kLabelDistance) places.push_back(p);
  }
  return places;
}

/// The arm at home from the side, as lines and as joints.
struct Side {
  std::vector<Vector3> links;  ///< shoulder, elbow, tool
  std::vector<Vector3> crank;  ///< shoulder, end of the crank, joint on the forearm
  std::vector<Vector3> joints;
  std::vector<Vector3> motors;  ///< mass centres of be and df
  std::vector<Vector3> stubs;   ///< motor, shoulder, motor

  explicit Side(const ArmParameters& arm) {
    const Vector3 shoulder{0.0, arm.l2_m, -arm.l1_m};
    const Vector3 elbow{0.0, arm.l2_m, 0.0};
    const Vector3 down{0.0, -arm.l3_m, 0.0};
    links = {shoulder, elbow, Vector3::Zero()};
    crank = {shoulder, shoulder + down, elbow + down};
    joints = {shoulder, elbow, shoulder + down, elbow + down};
    motors = {shoulder + Vector3{0.0, 0.0, arm.l5_m}, shoulder + Vector3{0.0, arm.l6_m, 0.0}};
    stubs = {motors.front(), shoulder, motors.back()};
  }
};

/// The page without the workspace: a frame, and the outline as a hole in it.
std::vector<Vector3> mask(const std::vector<Vector3>& outline,
                          const Vector3& low,
                          const Vector3& high) {
  std::vector<Vector3> ring{low, {0.0, low.y(), high.z()}, high, {0.0, high.y(), low.z()}, low};
  ring.insert(ring.end(), outline.begin(), outline.end());
  ring.push_back(outline.front());
  return ring;
}

/// Obstacles to labels: the outline, the arm, and the lines of the other levels.
std::vector<Vector3> obstacles_to(int level,
                                  const std::vector<Segments>& lines,
                                  const std::vector<Vector3>& outline,
                                  const Side& side) {
  std::vector<Vector3> obstacles = outline;
  for (std::size_t i = 0; i + 1 < side.links.size(); ++i) {
    constexpr int kPieces = 50;
    for (int k = 0; k <= kPieces; ++k) {
      obstacles.emplace_back(side.links[i] + static_cast<double>(k) / kPieces *
                                                 (side.links[i + 1] - side.links[i]));
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (static_cast<int>(i) + 1 == level) continue;
    for (std::size_t k = 0; k < lines[i].size(); k += 3) {
      obstacles.push_back(lines[i][k].first);
    }
  }
  return obstacles;
}

/// Lines μ = 0.1 … 0.9, each with gaps where its labels stand.
void add_lines(Script& script,
               const WorkspaceMap& map,
               const std::vector<Vector3>& outline,
               const Side& side) {
  std::vector<Segments> lines;
  for (int level = 1; level <= kLevels; ++level) {
    lines.push_back(contour(map, 0.1 * level));
  }
  script.add("$lines << END\n");
  std::string labels;
  for (int level = 1; level <= kLevels; ++level) {
    const Segments& line = lines[static_cast<std::size_t>(level - 1)];
    const auto places = label_places(map, line, obstacles_to(level, lines, outline, side));
    for (const auto& [a, b] : line) {
      if (is_under_label(a, places)) continue;
      script.add_point(a);
      script.add_point(b);
      script.add("\n");
    }
    for (const Vector3& p : places) {
      labels += fmt::format("set label \"{:.1f}\" at {:.1f},{:.1f} center front font \",16\"\n",
                            0.1 * level, kMillimetres * p.z(), kMillimetres * p.y());
    }
  }
  script.add("END\n{}", labels);
}

constexpr const char* kStyle = R"(set output "workspace.png"
set encoding utf8
set minussign
set datafile separator ","
set size ratio -1
set border 15 lw 1.5 lc rgb "#444444"
set tics out nomirror textcolor rgb "#222222"
set xtics 100
set ytics 100
set mxtics 2
set mytics 2
set xlabel "z (mm), towards the user"
set ylabel "y (mm), up"
set palette defined (0 "#ffffff", 1 "#3182ce")
set cbrange [0:1]
set cbtics 0.2 scale 0.5
set cblabel "manipulability {/:Italic μ} = {/:Italic σ}_{min} / {/:Italic σ}_{max}" offset 1
unset key
)";

/// Terminal and axes such that a millimetre is as long on both axes and the plot fills the canvas.
void add_page(Script& script, const Vector3& low, const Vector3& high) {
  constexpr double kPlotHeight = 1300.0;  // pixels
  constexpr double kLeft = 165.0;
  constexpr double kRight = 230.0;  // for the colour bar
  constexpr double kBottom = 125.0;
  constexpr double kTop = 85.0;
  const double plot_width = kPlotHeight * (high.z() - low.z()) / (high.y() - low.y());
  const double width = kLeft + plot_width + kRight;
  const double height = kBottom + kPlotHeight + kTop;
  script.add("set terminal pngcairo rounded size {:.0f},{:.0f} font \"DejaVu Sans,21\"\n", width,
             height);
  script.add("set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n", kLeft / width,
             (kLeft + plot_width) / width);
  script.add("set bmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n", kBottom / height,
             (kBottom + kPlotHeight) / height);
  script.add("set xrange [{:.2f}:{:.2f}]\nset yrange [{:.2f}:{:.2f}]\n", kMillimetres * low.z(),
             kMillimetres * high.z(), kMillimetres * low.y(), kMillimetres * high.y());
}

constexpr const char* kPlot = R"(plot "workspace.csv" every ::1 using 1:2:3 with image, \
  $lines with lines lw 2 lc rgb "#24527a", \
  $mask with filledcurves closed fillcolor rgb "white" fillstyle solid noborder, \
  $axis with lines lw 2 dashtype "_. " lc rgb "#888888", \
  $outline with lines lw 4 lc rgb "#111111", \
  $crank with lines lw 6 lc rgb "#8a8a8a", \
  $stubs with lines lw 6 lc rgb "#8a8a8a", \
  $motors with points pt 7 ps 5 lc rgb "#b5b5b5", \
  $motors with points pt 6 ps 5 lw 2 lc rgb "#555555", \
  $links with lines lw 15 lc rgb "white", \
  $links with lines lw 10 lc rgb "#c0561a", \
  $joints with points pt 7 ps 2.6 lc rgb "white", \
  $joints with points pt 6 ps 2.6 lw 3 lc rgb "#333333", \
  "+" every ::0::0 using (0):(0) with points pt 7 ps 3.2 lc rgb "#111111"
)";

}  // namespace

std::string workspace_picture(const ArmModel& arm, const WorkspaceMap& map) {
  const double margin = 0.045;
  const Side side{arm.parameters()};
  std::vector<Vector3> outline = workspace_outline(arm, 5e-3);
  if (outline.empty()) outline = side.links;
  outline.push_back(outline.front());
  Vector3 low = map.lowest_m;
  Vector3 high = map.highest_m;
  for (const auto* points : {&side.links, &side.motors}) {
    for (const Vector3& p : *points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  low.array() -= margin;
  high.array() += margin;
  Script script;
  add_page(script, low, high);
  script.add("{}", kStyle);
  script.add("set title \"{}: workspace in the plane x = 0\"\n", arm.parameters().name);
  add_lines(script, map, outline, side);
  const double z_axis = -arm.parameters().l1_m;
  script.add_label("yaw axis", {0.0, 0.0, z_axis}, "center rotate by 90 offset -0.9,0");
  script.add_label("motors", side.motors.front(), "center offset 0,-1.8");
  script.add_label("home", Vector3::Zero(), "right offset -0.9,-1.1");
  script.add_block("mask", mask(outline, low, high));
  script.add_block("outline", outline);
  script.add_block("axis", {{0.0, low.y(), z_axis}, {0.0, high.y(), z_axis}});
  script.add_block("links", side.links);
  script.add_block("crank", side.crank);
  script.add_block("joints", side.joints);
  script.add_block("motors", side.motors);
  script.add_block("stubs", side.stubs);
  script.add("{}", kPlot);
  return script.take();
}

}  // namespace teleop
