#pragma once

#include <string>
#include <vector>

namespace teleop {

/// Pictures for pages that are drawn once and need no script. Colours are names of the page's own
/// (page.css), so that they follow its light and dark looks.

/// Curves over a common axis; what is not a number breaks a line.
struct SvgPlot {
  struct Line {
    std::string label{};
    std::string color{};
    std::vector<double> x{};
    std::vector<double> y{};
    bool dashed = false;
  };
  /// Filled between two courses.
  struct Band {
    std::string label{};
    std::string color{};
    std::vector<double> x{};
    std::vector<double> low{};
    std::vector<double> high{};
  };
  std::string x_label{};
  std::string y_label{};
  double width = 560.0;
  double height = 250.0;
  bool log_x = false;
  bool log_y = false;
  double y_low = 0.0;  ///< with y_high: the range; both 0: what the curves need
  double y_high = 0.0;
  std::vector<Line> lines{};
  std::vector<Band> bands{};
};

/// A number over two quantities in cells, row by row from below: one colour for what is positive,
/// one for what is negative, stronger the larger; pale where it is not sure.
struct SvgMap {
  struct Cell {
    double value = 0.0;
    bool present = false;
    bool sure = false;
  };
  std::string x_label{};
  std::string y_label{};
  double width = 560.0;
  double height = 300.0;
  double x_low = 0.0;
  double x_high = 1.0;
  double y_low = 0.0;
  double y_high = 1.0;
  std::size_t columns = 0;
  std::size_t rows = 0;
  double scale = 1.0;  ///< value of the strongest colour
  std::vector<Cell> cells{};
};

/// An svg element with a legend before it where lines have names.
[[nodiscard]] std::string svg_of(const SvgPlot& plot);
[[nodiscard]] std::string svg_of(const SvgMap& map);

/// Round numbers between two ends, about `count` of them.
[[nodiscard]] std::vector<double> round_ticks(double low, double high, int count);

}  // namespace teleop
